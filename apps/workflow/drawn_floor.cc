#include "apps/workflow/drawn_floor.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "apps/workflow/compare.h"
#include "core/math/bisection.h"
#include "core/types/units.h"
#include "sim/physics/speckle.h"

namespace sonarcal::workflow {
namespace {

constexpr int kMeanCount = 1024;  // resolution of the table over mean values
constexpr int kMaxLevels = 1024;
constexpr std::uint64_t kSeed = 20240107;

// Returns the level in dB whose mean display is `value`. The mean display rises with the level.
double LevelShownAs(const sim::MeanDisplayTable& mean_display, const DisplayParameters<double>& display,
                    double value) {
  return Bisection(display.db_max - 200.0, display.db_max + 60.0,
                   [&](double level_db) { return mean_display(PowerFromDb(level_db)) < value; });
}

}  // namespace

SpeckleDraw::SpeckleDraw(const ParameterSet& parameters, double full_scale)
    : full_scale_(full_scale),
      levels_(static_cast<int>(std::clamp(std::round(full_scale), 1.0, double{kMaxLevels}))) {
  const double looks = parameters.receiver.looks;
  if (!(looks > 0.0)) throw DataError("receiver.looks is {}, expected more than 0", looks);
  const sim::MeanDisplayTable mean_display(parameters.display, looks);
  for (int step = 0; step <= kMeanCount; ++step) {
    const double value = static_cast<double>(step) / kMeanCount;
    const double power = PowerFromDb(LevelShownAs(mean_display, parameters.display, value));
    std::vector<float>& cumulative = cumulative_.emplace_back();
    for (int level = 0; level < levels_; ++level) {
      const double edge = (level + 0.5) / levels_;
      cumulative.push_back(static_cast<float>(sim::DisplayedCdf(parameters.display, looks, power, edge)));
    }
  }
}

Grid<float> SpeckleDraw::Draw(const Grid<float>& mean, std::uint64_t seed) const {
  std::mt19937_64 random(seed);
  Grid<float> drawn(mean.rows(), mean.cols());
  for (std::size_t i = 0; i < mean.size(); ++i) {
    const double value = std::clamp(static_cast<double>(mean.values()[i]) / full_scale_, 0.0, 1.0);
    const std::vector<float>& cumulative = cumulative_[static_cast<int>(std::lround(value * kMeanCount))];
    // std::uniform_real_distribution is not used: its results differ between standard libraries.
    const auto chance = static_cast<float>(static_cast<double>(random() >> 11) * 0x1p-53);
    const auto above = std::upper_bound(cumulative.begin(), cumulative.end(), chance);
    drawn.values()[i] =
        static_cast<float>(static_cast<double>(above - cumulative.begin()) / levels_ * full_scale_);
  }
  return drawn;
}

metrics::DrawnFloor DrawFloor(const RecordingSource& simulated, const std::vector<int>& frames,
                              const ParameterSet& parameters, const metrics::CompareOptions& options,
                              const std::map<int, metrics::PixelBox>& boxes, int max_frames) {
  metrics::CompareOptions of_draws = options;
  of_draws.keep_masks = false;
  of_draws.sweep = {};
  metrics::FrameComparer comparer(std::move(of_draws));
  std::optional<SpeckleDraw> draw;
  double full_scale = 0.0;
  std::vector<metrics::FrameMetrics> metrics;
  metrics::FrameLevels levels;
  for (const int index : EvenlySpread(frames, max_frames)) {
    const Frame frame = simulated.ReadFrame(index);
    if (!draw || full_scale != frame.image.scale.full_scale) {
      full_scale = frame.image.scale.full_scale;
      draw.emplace(parameters, full_scale);
    }
    PolarImage drawn = frame.image;
    drawn.value = draw->Draw(frame.image.value, kSeed + static_cast<std::uint64_t>(index));
    const metrics::PixelBox* box = options.object ? &boxes.at(index) : nullptr;
    metrics::FrameMetrics& of_frame = metrics.emplace_back(comparer.Compare(drawn, frame.image, box));
    of_frame.index = index;
    of_frame.name = frame.info.name;
    of_frame.time_s = frame.info.time_s;
    levels += of_frame.levels.value();
    of_frame.levels.reset();
  }
  return {.aggregate = metrics::AggregateFrames(metrics, std::move(levels)),
          .law = fmt::format("speckle of {:g} look{} about the simulated frames, independent from pixel to "
                             "pixel, through the display of the parameters",
                             parameters.receiver.looks, parameters.receiver.looks == 1.0 ? "" : "s")};
}

}  // namespace sonarcal::workflow
