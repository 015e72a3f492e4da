#include "calib/models/coarse_frame_model.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "calib/models/pixel_math.h"
#include "core/types/units.h"
#include "sim/physics/receiver.h"

namespace sonarcal::calib {
namespace {

int Blocks(int count, int of) {
  return (count + of - 1) / of;
}

// Speckle of blocks, which no display clips.
class SpeckleLaw final : public PixelLaw {
 public:
  explicit SpeckleLaw(double looks) : looks_(looks) {}

  void Add(double power, double weight) {
    power_.push_back(power);
    weight_.push_back(weight);
  }

  std::vector<double> Table(const GsabParameters<double>& curve) const override {
    std::vector<double> table;
    AppendCurve(curve, table);
    return table;
  }

  bool Judge(std::size_t first, std::span<const double> mean, PixelTerms& terms) const override {
    if (!std::ranges::all_of(mean, [](double value) { return value > 0.0 && std::isfinite(value); }))
      return false;
    pixel_math::Likelihood(&power_[first], mean.data(), static_cast<int>(mean.size()), looks_,
                           terms.residual.data(), terms.slope.data());
    for (std::size_t i = 0; i < mean.size(); ++i) {
      const double root = std::sqrt(weight_[first + i]);
      terms.residual[i] *= root;
      terms.slope[i] *= root / mean[i];
      terms.information[i] = weight_[first + i] * looks_ / (mean[i] * mean[i]);
    }
    return true;
  }

 private:
  double looks_;
  std::vector<double> power_;   // recorded
  std::vector<double> weight_;  // of the likelihood
};

}  // namespace

PolarAxes CoarseAxes(const PolarAxes& fine, const PixelBlock& block) {
  PolarAxes coarse = fine;
  coarse.range_bins = Blocks(fine.range_bins, block.bins);
  coarse.range_max_m = fine.range_min_m + coarse.range_bins * block.bins * fine.range_bin_m();
  coarse.beam_azimuth_rad.clear();
  for (int first = 0; first < fine.beam_count(); first += block.beams) {
    const int last = std::min(first + block.beams, fine.beam_count()) - 1;
    coarse.beam_azimuth_rad.push_back(0.5 * (fine.beam_azimuth_rad[first] + fine.beam_azimuth_rad[last]));
  }
  return coarse;
}

std::vector<double> CoarseTaper(const std::vector<double>& fine, int beams_at_once) {
  std::vector<double> coarse;
  for (std::size_t first = 0; first < fine.size(); first += beams_at_once) {
    const std::size_t last = std::min(first + beams_at_once, fine.size());
    double power = 0.0;
    for (std::size_t beam = first; beam < last; ++beam) power += PowerFromDb(fine[beam]);
    coarse.push_back(DbFromPower(power / static_cast<double>(last - first)));
  }
  return coarse;
}

CoarseFrameModel::CoarseFrameModel(const AcousticFrameModel& fine, const SonarModel& sonar,
                                   const std::vector<FrameEchoes>& echoes, const PixelBlock& block)
    : fine_(fine), block_(block), sonar_(sonar) {
  sonar_.axes = CoarseAxes(sonar.axes, block);
  const TimeVariedGain law = fine.Parameters(fine.initial_values()).receiver.time_varied_gain;
  const double absorption_db_per_m = fine.simulator().absorption_db_per_m();
  for (int bin = 0; bin < fine.range_bins(); ++bin) {
    gain_of_centre_.push_back(PowerFromDb(
        sim::TimeVariedGainDb(law, sonar.axes.range_centre_m(bin), absorption_db_per_m) -
        sim::TimeVariedGainDb(law, sonar_.axes.range_centre_m(bin / block.bins), absorption_db_per_m)));
  }
  frames_.resize(fine.frame_count());
  tbb::parallel_for(0, fine.frame_count(), [&](int frame) { frames_[frame] = Gather(frame, echoes[frame]); });
}

sim::PixelEchoes CoarseFrameModel::BlockEchoes(int frame, const sim::PixelEchoes& fine) const {
  sim::PixelEchoes echoes{.materials = fine.materials, .start = {0}, .entries = {}};
  std::vector<double> by_node(static_cast<std::size_t>(fine.materials) * sim::CoarseIncidenceDeg().size(),
                              0.0);
  std::vector<std::uint32_t> nodes;
  ForBlocks([&](const auto& for_pixels) {
    nodes.clear();
    int counted = 0;
    for_pixels([&](int bin, std::size_t pixel) {
      if (!fine_.Counts(frame, pixel)) return;
      ++counted;
      for (std::uint32_t e = fine.start[pixel]; e < fine.start[pixel + 1]; ++e) {
        const sim::PixelEchoes::Entry& entry = fine.entries[e];
        if (by_node[entry.node] == 0.0) nodes.push_back(entry.node);
        by_node[entry.node] += gain_of_centre_[bin] * entry.weight;
      }
    });
    std::sort(nodes.begin(), nodes.end());
    for (const std::uint32_t node : nodes) {
      if (by_node[node] > 0.0) echoes.entries.push_back({node, static_cast<float>(by_node[node] / counted)});
      by_node[node] = 0.0;
    }
    echoes.start.push_back(static_cast<std::uint32_t>(echoes.entries.size()));
  });
  return echoes;
}

CoarseFrameModel::CoarseFrame CoarseFrameModel::Gather(int frame, const FrameEchoes& fine) const {
  CoarseFrame coarse;
  coarse.echoes.at_point = BlockEchoes(frame, fine.at_point);
  if (!fine.ghosts.empty()) {
    coarse.echoes.ghosts = {.ways = fine.ghosts.ways,
                            .materials = fine.ghosts.materials,
                            .pixels = BlockEchoes(frame, fine.ghosts.pixels)};
  }
  ForBlocks([&](const auto& for_pixels) {
    double power = 0.0;
    double weight = 0.0;
    int counted = 0;
    for_pixels([&](int, std::size_t pixel) {
      if (!fine_.Counts(frame, pixel)) return;
      ++counted;
      weight += fine_.Weight(frame, pixel);
      power += fine_.frame(frame).recorded[pixel].power;
    });
    coarse.power.push_back({.power = counted > 0 ? power / counted : 0.0});
    coarse.use.push_back(counted > 0 ? 1 : 0);
    coarse.weight.push_back(static_cast<float>(weight / PixelsOfBlock()));
  });
  return coarse;
}

std::unique_ptr<FrameEvaluation> CoarseFrameModel::At(int frame, const ParameterValues& values,
                                                      std::span<const int> active, Terms wanted) const {
  return Evaluation(frame, values, active, wanted);
}

std::unique_ptr<AcousticEvaluation> CoarseFrameModel::Evaluation(int frame, const ParameterValues& values,
                                                                 std::span<const int> active,
                                                                 Terms wanted) const {
  ParameterSet parameters = fine_.Parameters(values);
  ReceiverParameters& receiver = parameters.receiver;
  receiver.looks *= PixelsOfBlock();
  receiver.noise_taper_db = CoarseTaper(receiver.noise_taper_db, block_.beams);
  receiver.noise_after_gain_taper_db = CoarseTaper(receiver.noise_after_gain_taper_db, block_.beams);
  const AcousticState state{.catalog = catalog(),
                            .material_names = material_names(),
                            .sonar = sonar_,
                            .absorption_db_per_m = fine_.simulator().absorption_db_per_m(),
                            .parameters = parameters,
                            .values = values,
                            .point = values,
                            .clips = false};
  const CoarseFrame& of = frames_[frame];
  const std::span<const int> differentiated = wanted == Terms::kResiduals ? std::span<const int>{} : active;
  return std::make_unique<AcousticEvaluation>(
      state, of.echoes,
      RecordedFrame{.power = of.power, .use = of.use, .weight = of.weight, .repeat_share = {}},
      differentiated, wanted);
}

std::unique_ptr<OneCurveModel> CoarseFrameModel::OfCurve(int material, const ParameterValues& values) const {
  OneCurvePixels pixels;
  auto law = std::make_unique<SpeckleLaw>(PixelsOfBlock() * fine_.Parameters(values).receiver.looks);
  for (int frame = 0; frame < frame_count(); ++frame) {
    const CoarseFrame& of = frames_[frame];
    if (!of.echoes.ghosts.empty()) return nullptr;
    const auto evaluation = Evaluation(frame, values, {}, Terms::kResiduals);
    const std::vector<double> means = evaluation->Means();
    for (std::size_t pixel = 0; pixel < means.size(); ++pixel) {
      if (of.use[pixel] == 0) continue;
      if (pixels.Add(of.echoes.at_point, pixel, material, evaluation->gain(static_cast<int>(pixel) / beams()),
                     evaluation->curves(), means[pixel]))
        law->Add(of.power[pixel].power, of.weight[pixel]);
    }
  }
  return std::make_unique<OneCurveModel>(*this, material, std::move(pixels), std::move(law));
}

}  // namespace sonarcal::calib
