#include "calib/selection/held_out_likelihood.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calib/noise/noise_likelihood.h"
#include "core/imaging/saturation.h"
#include "core/math/pose_groups.h"
#include "core/math/statistics.h"
#include "core/types/error.h"

namespace sonarcal::calib {
namespace {

int FullScale(const PolarImage& image) {
  if (image.scale.quantity != Quantity::kGrey) {
    throw DataError("fit: the recorded image holds {}, expected grey levels", ToString(image.scale.quantity));
  }
  return static_cast<int>(std::lround(image.scale.full_scale));
}

int Top(const PolarImage& image) {
  return static_cast<int>(std::lround(TopLevel(image)));
}

GreyLevels LevelsOf(const ParameterSet& parameters, const PolarImage& image) {
  return {NoiseLaw{.display = parameters.display, .receiver = parameters.receiver}, FullScale(image), false};
}

// `top`: level that stands for all higher ones, too.
double LogChance(const GreyLevels& levels, int full_scale, int top, int level, double mean_power) {
  const QuantileBound lower = levels.Bound(level - 1, mean_power);
  const QuantileBound upper = levels.Bound(level >= top ? full_scale : level, mean_power);
  const double chance = lower.below < 0.5 ? upper.below - lower.below : lower.beyond - upper.beyond;
  return std::log((1.0 - kOutlierFraction) * std::max(chance, 0.0) + kOutlierFraction / (full_scale + 1.0));
}

bool Counts(const GreyFrame& frame, std::size_t pixel) {
  return frame.use.empty() || frame.use[pixel] != 0;
}

void CheckSizes(const GreyFrame& frame, const std::vector<double>& mean_power) {
  const std::size_t pixels = frame.image.value.size();
  if (mean_power.size() != pixels || (!frame.use.empty() && frame.use.size() != pixels)) {
    throw DataError("fit: frame {} has {} pixels, expected {}", frame.index, pixels, mean_power.size());
  }
  const auto bad = std::find_if(mean_power.begin(), mean_power.end(),
                                [](double mean) { return !(mean > 0.0) || !std::isfinite(mean); });
  if (bad != mean_power.end()) throw DataError("fit: frame {}: a mean power of {}", frame.index, *bad);
}

// Uses every `every`-th of the used pixels of all frames.
double LogLikelihood(const std::vector<GreyFrame>& frames, const std::vector<std::vector<double>>& mean_power,
                     const ParameterSet& parameters, std::size_t every) {
  double nats = 0.0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const GreyLevels levels = LevelsOf(parameters, frames[f].image);
    const int full_scale = FullScale(frames[f].image);
    const int top = Top(frames[f].image);
    const auto values = frames[f].image.value.values();
    for (std::size_t pixel = f % every; pixel < values.size(); pixel += every) {
      if (!Counts(frames[f], pixel)) continue;
      nats += LogChance(levels, full_scale, top, static_cast<int>(std::lround(values[pixel])),
                        mean_power[f][pixel]);
    }
  }
  return nats;
}

// Sums log_chance_of(frame)(level, pixel) over the used pixels, per block.
template <typename LogChanceOf>
BlockedLikelihood InBlocks(const std::vector<GreyFrame>& frames, int block_bins, int block_beams,
                           const LogChanceOf& log_chance_of) {
  SONARCAL_CHECK(block_bins > 0 && block_beams > 0, "blocks of {} x {} pixels", block_bins, block_beams);
  BlockedLikelihood all;
  std::vector<Pose> poses;
  for (const auto& frame : frames) poses.push_back(frame.world_from_sonar);
  const std::vector<int> first_of_pose = FirstOfPose(poses);
  std::vector<std::size_t> first_block(frames.size());
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const int bins = frames[f].image.axes.range_bins;
    const int beams = frames[f].image.axes.beam_count();
    const int down = (bins + block_bins - 1) / block_bins;
    const int across = (beams + block_beams - 1) / block_beams;
    // Frames of one pose share their speckle, and so their blocks.
    const auto same = static_cast<std::size_t>(first_of_pose[f]);
    first_block[f] = same < f ? first_block[same] : all.nats.size();
    if (same == f) {
      all.nats.resize(all.nats.size() + static_cast<std::size_t>(down) * across, 0.0);
      all.pixels.resize(all.nats.size(), 0.0);
    }
    const auto log_chance = log_chance_of(f);
    // Each band of blocks has one thread, so that the sums do not depend on the number of threads.
    tbb::parallel_for(0, down, [&](int band) {
      for (int bin = band * block_bins; bin < std::min((band + 1) * block_bins, bins); ++bin) {
        for (int beam = 0; beam < beams; ++beam) {
          const std::size_t pixel = static_cast<std::size_t>(bin) * beams + beam;
          if (!Counts(frames[f], pixel)) continue;
          const std::size_t block =
              first_block[f] + static_cast<std::size_t>(band) * across + beam / block_beams;
          all.nats[block] +=
              log_chance(static_cast<int>(std::lround(frames[f].image.value(bin, beam))), pixel);
          all.pixels[block] += 1.0;
        }
      }
    });
  }
  return all;
}

}  // namespace

std::vector<AcousticFrame> FramesFor(const std::vector<GreyFrame>& frames,
                                     const DisplayParameters<double>& display) {
  std::vector<AcousticFrame> result;
  result.reserve(frames.size());
  for (const GreyFrame& frame : frames) {
    result.push_back({.index = frame.index,
                      .world_from_sonar = frame.world_from_sonar,
                      .recorded = RecordedPowers(frame.image, display),
                      .use = frame.use,
                      .pings = frame.pings});
  }
  return result;
}

std::vector<std::vector<double>> MeanPowers(const AcousticFrameModel& model) {
  std::vector<std::vector<double>> means;
  means.reserve(model.frame_count());
  for (int frame = 0; frame < model.frame_count(); ++frame)
    means.push_back(model.MeanPower(frame, model.initial_values()));
  return means;
}

double BlockedLikelihood::Pixels() const {
  return std::accumulate(pixels.begin(), pixels.end(), 0.0);
}

double BlockedLikelihood::PerPixel() const {
  return std::accumulate(nats.begin(), nats.end(), 0.0) / std::max(1.0, Pixels());
}

BlockedLikelihood GreyLikelihood(const std::vector<GreyFrame>& frames,
                                 const std::vector<std::vector<double>>& mean_power,
                                 const ParameterSet& parameters, int block_bins, int block_beams) {
  for (std::size_t f = 0; f < frames.size(); ++f) CheckSizes(frames[f], mean_power[f]);
  return InBlocks(frames, block_bins, block_beams, [&](std::size_t f) {
    return [levels = LevelsOf(parameters, frames[f].image), full_scale = FullScale(frames[f].image),
            top = Top(frames[f].image), &mean = mean_power[f]](int level, std::size_t pixel) {
      return LogChance(levels, full_scale, top, level, mean[pixel]);
    };
  });
}

std::optional<double> LogLikelihoodPerPixel(const sim::Simulator& simulator, const GreyFrame& frame,
                                            const ParameterSet& parameters) {
  if (!parameters.receiver.noise_db) return std::nullopt;
  const std::vector<GreyFrame> frames = {frame};
  const std::vector<AcousticFrame> powers = FramesFor(frames, parameters.display);
  const AcousticFrameModel model(simulator, powers, parameters);
  const PolarAxes& axes = frame.image.axes;
  return GreyLikelihood(frames, MeanPowers(model), parameters, axes.range_bins, axes.beam_count()).PerPixel();
}

NormalGreyLaw FindNormalGreyLaw(const std::vector<GreyFrame>& frames,
                                const std::vector<std::vector<double>>& expected_grey) {
  std::vector<double> off;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const auto values = frames[f].image.value.values();
    for (std::size_t pixel = 0; pixel < values.size(); ++pixel) {
      if (Counts(frames[f], pixel)) off.push_back(values[pixel] - expected_grey[f][pixel]);
    }
  }
  if (off.empty()) throw DataError("fit: no pixels");
  NormalGreyLaw law{.offset = UpperMedian(off)};
  for (double& value : off) value = std::abs(value - law.offset);
  law.sigma = std::max(kSigmaPerMad * UpperMedian(std::move(off)), 0.5);  // at least the rounding of a level
  return law;
}

BlockedLikelihood GreyLikelihood(const std::vector<GreyFrame>& frames,
                                 const std::vector<std::vector<double>>& expected_grey,
                                 const NormalGreyLaw& law, int block_bins, int block_beams) {
  return InBlocks(frames, block_bins, block_beams, [&](std::size_t f) {
    return [&law, full_scale = FullScale(frames[f].image), top = Top(frames[f].image),
            &expected = expected_grey[f]](int level, std::size_t pixel) {
      const double middle = expected[pixel] + law.offset;
      const auto below = [&](double grey) {
        return 0.5 * std::erfc((middle - grey) / (law.sigma * std::sqrt(2.0)));
      };
      const double lower = level <= 0 ? 0.0 : below(level - 0.5);
      const double upper = level >= top ? 1.0 : below(level + 0.5);
      return std::log((1.0 - kOutlierFraction) * std::max(upper - lower, 0.0) +
                      kOutlierFraction / (full_scale + 1.0));
    };
  });
}

BlockedLikelihood GreyError(const std::vector<GreyFrame>& frames,
                            const std::vector<std::vector<double>>& shown, int block_bins, int block_beams) {
  return InBlocks(frames, block_bins, block_beams, [&](std::size_t f) {
    return [full_scale = FullScale(frames[f].image), &of = shown[f]](int level, std::size_t pixel) {
      return std::abs(level - of[pixel]) / full_scale;
    };
  });
}

LikelihoodDifference Difference(const BlockedLikelihood& a, const BlockedLikelihood& b) {
  SONARCAL_CHECK(a.pixels == b.pixels, "likelihoods of other pixels");
  const double pixels = a.Pixels();
  LikelihoodDifference difference{.mean = a.PerPixel() - b.PerPixel()};
  double square = 0.0;
  int blocks = 0;
  for (std::size_t i = 0; i < a.nats.size(); ++i) {
    if (a.pixels[i] == 0.0) continue;
    const double deviation = a.nats[i] - b.nats[i] - a.pixels[i] * difference.mean;
    square += deviation * deviation;
    ++blocks;
  }
  if (blocks > 1) difference.sigma = std::sqrt(a.variance_factor * square * blocks / (blocks - 1.0)) / pixels;
  return difference;
}

double BestLooks(const std::vector<GreyFrame>& frames, const std::vector<std::vector<double>>& mean_power,
                 const ParameterSet& parameters) {
  constexpr std::size_t kEnoughPixels = 50'000;  // determine looks to 0.5 %
  constexpr double kGolden = 0.6180339887498949;
  constexpr double kTolerance = 2e-3;  // in ln looks
  std::size_t pixels = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    CheckSizes(frames[f], mean_power[f]);
    pixels += mean_power[f].size();
  }
  // Odd, so that all beams are used if their number is even.
  const std::size_t every = std::max<std::size_t>(1, pixels / kEnoughPixels) | 1U;
  const auto at = [&](double log_looks) {
    ParameterSet with = parameters;
    with.receiver.looks = std::exp(log_looks);
    return LogLikelihood(frames, mean_power, with, every);
  };
  double a = std::log(kMinSimulatedLooks);
  double b = std::log(kMaxSimulatedLooks);
  double c = b - kGolden * (b - a);
  double d = a + kGolden * (b - a);
  double at_c = at(c);
  double at_d = at(d);
  while (b - a > kTolerance) {
    const bool left = at_c > at_d;
    (left ? b : a) = left ? d : c;
    (left ? d : c) = left ? c : d;
    (left ? at_d : at_c) = left ? at_c : at_d;
    double& fresh = left ? c : d;
    fresh = left ? b - kGolden * (b - a) : a + kGolden * (b - a);
    (left ? at_c : at_d) = at(fresh);
  }
  return std::exp(0.5 * (a + b));
}

}  // namespace sonarcal::calib
