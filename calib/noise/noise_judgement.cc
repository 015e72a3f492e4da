#include "calib/noise/noise_judgement.h"

#include <algorithm>
#include <cmath>

#include "calib/fitted_curve.h"
#include "calib/noise/noise_solver.h"
#include "core/types/error.h"

namespace sonarcal::calib {
namespace {

constexpr double kMaxCorrelation = 0.95;
constexpr int kPingsPerPart = 10;

void CheckTaper(const std::vector<double>& taper, const RecordingInfo& info, const char* name) {
  const std::size_t beams = info.sonar.axes.beam_azimuth_rad.size();
  if (!taper.empty() && taper.size() != beams) {
    throw DataError("{}: {} beams, but the noise law has {} values of {}, expected as many", info.source,
                    beams, taper.size(), name);
  }
}

void CheckLaw(const NoiseLaw& law, const RecordingInfo& info) {
  if (!law.receiver.noise_db && !law.receiver.noise_after_gain_db) {
    throw DataError(
        "{}: the noise law has no noise level, expected receiver.noise_db or receiver.noise_after_gain_db",
        info.source);
  }
  const double min_looks = MinNoiseLooks(law.speckle);
  if (law.speckle != sim::SpeckleLaw::kGamma && law.receiver.looks < min_looks) {
    throw DataError("{}: the noise law has {} speckle and receiver.looks {}, expected at least {}",
                    info.source, ToString(law.speckle), law.receiver.looks, min_looks);
  }
  const bool has_diffuse_share = law.receiver.diffuse_share > 0.0 && law.receiver.looks < 1.0;
  if (has_diffuse_share && law.speckle != sim::SpeckleLaw::kKDiffuse) {
    throw DataError(
        "{}: the noise law has receiver.diffuse_share {} and {} speckle, expected k_diffuse speckle",
        info.source, law.receiver.diffuse_share, ToString(law.speckle));
  }
  CheckTaper(law.receiver.noise_taper_db, info, "receiver.noise_taper_db");
  CheckTaper(law.receiver.noise_after_gain_taper_db, info, "receiver.noise_after_gain_taper_db");
}

double MeanOf(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

}  // namespace

double ChanceKs(double pixels) {
  return 1.63 / std::sqrt(pixels);
}

std::optional<NoiseDrift> DriftOf(std::span<const int> frame, std::span<const double> level_db) {
  const int count = static_cast<int>(frame.size());
  if (count < kMinPingsForDrift) return std::nullopt;
  const std::vector<double> place(frame.begin(), frame.end());
  const double mean_place = MeanOf(place);
  const double mean_db = MeanOf(level_db);
  double spread_place = 0.0;
  double product = 0.0;
  for (int i = 0; i < count; ++i) {
    spread_place += (place[i] - mean_place) * (place[i] - mean_place);
    product += (place[i] - mean_place) * (level_db[i] - mean_db);
  }
  NoiseDrift drift{
      .trend_db_per_ping = product / spread_place, .first_frame = frame.front(), .last_frame = frame.back()};
  std::vector<double> residual;
  double square = 0.0;
  double neighbours = 0.0;
  for (int i = 0; i < count; ++i) {
    residual.push_back(level_db[i] - mean_db - drift.trend_db_per_ping * (place[i] - mean_place));
    square += residual[i] * residual[i];
    if (i > 0) neighbours += residual[i] * residual[i - 1];
  }
  drift.spread_db = std::sqrt(square / (count - 2));
  if (square > 0.0) drift.lag_one = neighbours / square;
  // The correlation of the residuals of a line is too small by about (2 + 4 rho) / n (Kendall, 1954).
  const double correlation =
      std::clamp(drift.lag_one + (2.0 + 4.0 * drift.lag_one) / count, 0.0, kMaxCorrelation);
  const double sigma_db = drift.spread_db * std::sqrt((1.0 + correlation) / (1.0 - correlation));
  drift.trend_sigma = sigma_db / std::sqrt(spread_place);
  drift.significant = std::abs(drift.trend_db_per_ping) > kSigmasOf95 * drift.trend_sigma;
  const int parts = std::clamp(count / kPingsPerPart, 2, 4);
  for (int part = 0; part < parts; ++part) {
    const int first = count * part / parts;
    const int end = count * (part + 1) / parts;
    drift.parts.push_back({.first_frame = frame[first],
                           .last_frame = frame[end - 1],
                           .level_db = MeanOf(level_db.subspan(first, end - first)),
                           .sigma_db = sigma_db / std::sqrt(static_cast<double>(end - first))});
  }
  return drift;
}

int NoiseJudgement::pings_beyond_chance() const {
  return static_cast<int>(
      std::ranges::count_if(pings, [](const NoisePing& ping) { return ping.ks > ChanceKs(ping.pixels); }));
}

int NoiseJudgement::cells_beyond_chance() const {
  return static_cast<int>(std::ranges::count_if(
      agreement.blocks, [](const NoiseBlock& block) { return block.ks > ChanceKs(block.pixels); }));
}

NoiseCells NoiseCellsOf(const RecordingInfo& info, const NoiseWindow& window) {
  NoiseCells cells{.axes = info.sonar.axes, .valid = info.valid};
  if (info.scale.quantity != Quantity::kGrey || !(info.scale.full_scale <= 4095.0)) {
    throw DataError("{}: {} images of full scale {}; a noise law is fitted to grey images of up to 12 bits",
                    info.source, ToString(info.scale.quantity), info.scale.full_scale);
  }
  cells.full_scale = static_cast<int>(info.scale.full_scale);
  const auto bin_of = [&](double range_m) {
    return static_cast<int>(std::lround((range_m - cells.axes.range_min_m) / cells.axes.range_bin_m()));
  };
  cells.first_bin = window.skip_bins;
  cells.last_bin = cells.axes.range_bins;
  if (window.range_min_m) cells.first_bin = std::max(cells.first_bin, bin_of(*window.range_min_m));
  if (window.range_max_m) cells.last_bin = std::min(cells.last_bin, bin_of(*window.range_max_m));
  cells.band_bins = window.band_bins;
  if (cells.last_bin - cells.first_bin < cells.band_bins) {
    throw DataError("{}: {} range bins in the window, expected at least {}", info.source,
                    std::max(0, cells.last_bin - cells.first_bin), cells.band_bins);
  }
  return cells;
}

NoiseJudgement JudgeNoise(const NoiseLaw& law, const RecordingSource& recording,
                          const std::vector<int>& frames, const NoiseCells& cells,
                          const std::vector<double>& weight, double absorption_db_per_m,
                          const std::function<void(int done, int total)>& progress) {
  CheckLaw(law, recording.info());
  SONARCAL_CHECK(weight.empty() || static_cast<int>(weight.size()) == cells.count(), "{} weights of {} cells",
                 weight.size(), cells.count());
  NoiseJudgement judgement{.cells = cells, .weight = weight, .frames = frames};
  std::vector<NoiseCounts> counts;
  std::vector<double> level_db;
  for (const int frame : frames) {
    counts.push_back(CountGrey(recording.ReadFrame(frame).image, cells));
    const NoiseAgreement agreement = Agreement(law, counts.back(), cells, weight, absorption_db_per_m);
    const NoiseLevel level = FitNoiseLevel(law, counts.back(), cells, weight, absorption_db_per_m);
    judgement.pings.push_back({.frame = frame,
                               .ks = agreement.ks,
                               .wasserstein_grey = agreement.wasserstein_grey,
                               .whitened = agreement.whitened,
                               .level_db = level.level_db,
                               .level_sigma_db = level.sigma_db,
                               .pixels = agreement.pixels});
    level_db.push_back(level.level_db);
    if (progress) progress(static_cast<int>(counts.size()), static_cast<int>(frames.size()));
  }
  judgement.agreement = Agreement(law, AddCounts(counts, cells), cells, weight, absorption_db_per_m);
  if (std::ranges::is_sorted(frames)) judgement.drift = DriftOf(frames, level_db);
  return judgement;
}

}  // namespace sonarcal::calib
