#include "calib/noise/noise_likelihood.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/distribution.h"
#include "core/math/statistics.h"

namespace sonarcal::calib {
namespace {

constexpr double kLooksStep = 1e-5;  // step of ln looks, for a difference
constexpr double kDbStep = 1e-5;

void Normalise(std::vector<double>& values, double sum) {
  for (double& value : values) value /= sum;
}

double MeanLevel(const std::vector<double>& shares) {
  double mean = 0.0;
  for (std::size_t level = 0; level < shares.size(); ++level)
    mean += static_cast<double>(level) * shares[level];
  return mean;
}

// Recorded and predicted levels of a block of cells.
struct Levels {
  explicit Levels(int levels) : recorded(levels), predicted(levels) {}

  void Add(const std::vector<LevelCount>& counts, const std::vector<double>& chance) {
    double all = 0.0;
    for (const auto& [level, count] : counts) {
      recorded[level] += count;
      all += count;
    }
    for (std::size_t level = 0; level < chance.size(); ++level) predicted[level] += all * chance[level];
    pixels += all;
  }

  std::vector<double> recorded;
  std::vector<double> predicted;
  double pixels = 0.0;
};

// Mean and spread from sums over pixels.
class Moments {
 public:
  void Add(double mean, double square, double pixels) {
    sum_ += pixels * mean;
    square_ += pixels * square;
    pixels_ += pixels;
  }
  ResidualSummary Summary() const {
    const double mean = sum_ / pixels_;
    return {mean, std::sqrt(std::max(0.0, square_ / pixels_ - mean * mean))};
  }

 private:
  double sum_ = 0.0;
  double square_ = 0.0;
  double pixels_ = 0.0;
};

}  // namespace

GreyLevels::GreyLevels(const NoiseLaw& law, int full_scale, bool by_looks)
    : law_(law), closed_form_(law.speckle), by_looks_(by_looks) {
  if (law.speckle == sim::SpeckleLaw::kKDiffuse) {
    closed_form_ = sim::SpeckleLaw::kK;
    const double looks = law.receiver.looks;
    if (looks < 1.0 && law.receiver.diffuse_share > 0.0)
      with_diffuse_.emplace(looks, law.receiver.diffuse_share);
  }
  const auto power_at = [&](double value, double span_step, double soft_step) {
    DisplayParameters<double> display = law.display;
    display.soft_db += soft_step;
    if (display.law == DisplayLaw::kPower) return sim::PowerFromDisplay(display, value);
    display.db_max += span_step;
    return sim::PowerFromDisplay(display, value);
  };
  for (int level = 0; level < full_scale; ++level) {
    const double value = (level + 0.5) / full_scale;
    edge_power_.push_back(power_at(value, 0.0, 0.0));
    edge_by_span_.push_back((power_at(value, kDbStep, 0.0) - power_at(value, -kDbStep, 0.0)) /
                            (2.0 * kDbStep));
    edge_by_soft_db_.push_back((power_at(value, 0.0, kDbStep) - power_at(value, 0.0, -kDbStep)) /
                               (2.0 * kDbStep));
  }
}

double GreyLevels::Cdf(int level, double noise_power) const {
  if (level < 0) return 0.0;
  if (level >= static_cast<int>(edge_power_.size())) return 1.0;
  const double ratio = RatioAt(level, noise_power);
  if (with_diffuse_) return with_diffuse_->At(ratio).cdf;
  return sim::SpeckleCdf(law_.receiver.looks, ratio, closed_form_);
}

QuantileBound GreyLevels::Bound(int level, double noise_power) const {
  if (level < 0) return {.below = 0.0, .beyond = 1.0};
  if (level >= static_cast<int>(edge_power_.size())) return {.below = 1.0, .beyond = 0.0};
  return BoundAt(RatioAt(level, noise_power));
}

QuantileBound GreyLevels::BoundAt(double ratio) const {
  if (with_diffuse_) {
    const sim::KDiffuseLaw::Value at = with_diffuse_->At(ratio);
    return {.below = at.cdf, .beyond = at.survival};
  }
  const double looks = law_.receiver.looks;
  return {.below = sim::SpeckleCdf(looks, ratio, closed_form_),
          .beyond = sim::SpeckleSurvival(looks, ratio, closed_form_)};
}

sim::KDiffuseLaw::Value GreyLevels::SpeckleAt(double ratio) const {
  if (with_diffuse_) return with_diffuse_->At(ratio);
  const double looks = law_.receiver.looks;
  const QuantileBound bound = BoundAt(ratio);
  sim::KDiffuseLaw::Value speckle{.cdf = bound.below,
                                  .survival = bound.beyond,
                                  .density = sim::SpeckleDensity(looks, ratio, closed_form_)};
  if (!by_looks_) return speckle;
  const double more = looks * std::exp(kLooksStep);
  speckle.cdf_by_log_looks =
      speckle.cdf < 0.5 ? (sim::SpeckleCdf(more, ratio, closed_form_) - speckle.cdf) / kLooksStep
                        : (speckle.survival - sim::SpeckleSurvival(more, ratio, closed_form_)) / kLooksStep;
  return speckle;
}

GreyLevels::Chance GreyLevels::Below(int level, double noise_power) const {
  if (level < 0) return {.value = 0.0, .beyond = 1.0};
  if (level >= static_cast<int>(edge_power_.size())) return {.value = 1.0, .beyond = 0.0};
  const double ratio = RatioAt(level, noise_power);
  const sim::KDiffuseLaw::Value at = SpeckleAt(ratio);
  Chance below{.value = at.cdf, .beyond = at.survival};
  below.derivative[0] = -ratio * at.density;
  below.derivative[1] = at.cdf_by_log_looks;
  below.derivative[2] = at.density * edge_by_span_[level] / noise_power;
  below.derivative[3] = at.density * edge_by_soft_db_[level] / noise_power;
  below.derivative[4] = at.cdf_by_logit_share;
  return below;
}

GreyLevels::Chance GreyLevels::Between(const Chance& lower, const Chance& upper) {
  constexpr double kSmallestChance = 1e-300;
  Chance chance{.value = lower.value < 0.5 ? upper.value - lower.value : lower.beyond - upper.beyond};
  if (!(chance.value > kSmallestChance)) return {.value = kSmallestChance};
  for (int i = 0; i < kDerivatives; ++i) chance.derivative[i] = upper.derivative[i] - lower.derivative[i];
  return chance;
}

NoiseAgreement Agreement(const NoiseLaw& law, const NoiseCounts& counts, const NoiseCells& cells,
                         const std::vector<double>& weight, double absorption_db_per_m) {
  const GreyLevels grey(law, cells.full_scale);
  const int levels = cells.full_scale + 1;
  const int judge_bands = std::max(1, kJudgeBins / cells.band_bins);
  const int judge_cols = (cells.beams() + kJudgeBeams - 1) / kJudgeBeams;
  const int judge_rows = (cells.bands() + judge_bands - 1) / judge_bands;
  std::vector<Levels> blocks(static_cast<std::size_t>(judge_rows) * judge_cols, Levels(levels));
  Levels all(levels);
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  NoiseAgreement agreement;
  agreement.recorded_mean = Grid<float>(cells.bands(), cells.beams(), kNone);
  agreement.predicted_mean = Grid<float>(cells.bands(), cells.beams(), kNone);
  agreement.whitened_mean = Grid<float>(cells.bands(), cells.beams(), kNone);

  Moments raw;
  Moments whitened;
  std::vector<double> chance(levels);
  for (int cell = 0; cell < cells.count(); ++cell) {
    if (!weight.empty() && weight[cell] == 0.0) continue;
    const int band = cell / cells.beams();
    const int beam = cell % cells.beams();
    const double power = sim::NoisePower(law.receiver, cells.RangeM(band), beam, absorption_db_per_m);
    double below = 0.0;
    double predicted_mean = 0.0;
    for (int level = 0; level < levels; ++level) {
      const double next = below < 1.0 ? grey.Cdf(level, power) : 1.0;
      chance[level] = next - below;
      predicted_mean += level * chance[level];
      below = next;
    }
    double recorded_sum = 0.0;
    double whitened_sum = 0.0;
    double pixels = 0.0;
    for (const auto& [level, count] : counts[cell]) {
      agreement.nats_per_pixel -= count * std::log(std::max(chance[level], 1e-30));
      recorded_sum += static_cast<double>(count) * level;
      pixels += count;
      const double off = (level - predicted_mean) / cells.full_scale;
      raw.Add(off, off * off, count);
      const QuantileMoments quantile =
          QuantileResidual(grey.Bound(level - 1, power), grey.Bound(level, power));
      whitened.Add(quantile.mean, quantile.square, count);
      whitened_sum += count * quantile.mean;
    }
    if (pixels == 0.0) continue;
    agreement.recorded_mean(band, beam) = static_cast<float>(recorded_sum / pixels);
    agreement.whitened_mean(band, beam) = static_cast<float>(whitened_sum / pixels);
    agreement.predicted_mean(band, beam) = static_cast<float>(predicted_mean);
    all.Add(counts[cell], chance);
    blocks[static_cast<std::size_t>(band / judge_bands) * judge_cols + beam / kJudgeBeams].Add(counts[cell],
                                                                                               chance);
  }
  if (all.pixels == 0.0) throw DataError("no pixel remains to evaluate a noise law");

  agreement.raw = raw.Summary();
  agreement.whitened = whitened.Summary();
  agreement.nats_per_pixel /= all.pixels;
  Normalise(all.recorded, all.pixels);
  Normalise(all.predicted, all.pixels);
  agreement.ks = KolmogorovSmirnov(all.recorded, all.predicted);
  agreement.wasserstein_grey = WassersteinLevels(all.recorded, all.predicted);
  agreement.pixels = all.pixels;
  std::vector<double> by_block;
  for (int i = 0; i < judge_rows * judge_cols; ++i) {
    Levels& block = blocks[i];
    if (block.pixels == 0.0) continue;
    Normalise(block.recorded, block.pixels);
    Normalise(block.predicted, block.pixels);
    by_block.push_back(KolmogorovSmirnov(block.recorded, block.predicted));
    const int band = i / judge_cols * judge_bands;
    const int beam = i % judge_cols * kJudgeBeams;
    agreement.blocks.push_back({.first_bin = cells.first_bin + band * cells.band_bins,
                                .end_bin = cells.EndOfBand(std::min(band + judge_bands, cells.bands()) - 1),
                                .first_beam = beam,
                                .end_beam = std::min(beam + kJudgeBeams, cells.beams()),
                                .pixels = block.pixels,
                                .ks = by_block.back(),
                                .recorded_mean = MeanLevel(block.recorded),
                                .predicted_mean = MeanLevel(block.predicted)});
  }
  if (!by_block.empty()) {
    agreement.cell_ks_median = Quantile(by_block, 0.5);
    agreement.cell_ks_p95 = Quantile(by_block, 0.95);
  }
  agreement.recorded = std::move(all.recorded);
  agreement.predicted = std::move(all.predicted);
  return agreement;
}

}  // namespace sonarcal::calib
