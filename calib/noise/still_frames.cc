#include "calib/noise/still_frames.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "calib/noise/still_likelihood.h"
#include "core/math/statistics.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/display.h"

namespace sonarcal::calib {
namespace {

// Limit for the mean square change of a frame's brightest pixels, relative to their power, times the looks.
// Fresh speckle has about 1; noise 9 dB below the echoes has 0.25.
constexpr double kMoved = 0.25;
constexpr double kBrightestShare = 0.01;
constexpr std::size_t kMinBright = 50;

constexpr std::size_t kFirstLookPixels = 20000;
constexpr double kFirstStepDb = 1.0;
constexpr double kStepDb = 0.2;
constexpr int kMaxSteps = 60;

// Pixels this far above the noise check the level from all pixels.
constexpr double kBrightDb = 13.0;
constexpr double kBrightSigmaDb = 1.0;  // larger standard errors check nothing

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

struct Stack {
  GreyClasses classes;
  int range_bins = 0;
  int beams = 0;
  std::vector<std::vector<std::uint16_t>> frames;  // class per pixel

  std::size_t pixels() const { return static_cast<std::size_t>(range_bins) * beams; }
  double MeanPower(std::size_t pixel) const {
    double sum = 0.0;
    for (const auto& frame : frames) sum += classes.Power(frame[pixel]);
    return sum / static_cast<double>(frames.size());
  }
  bool ReachesTop(std::size_t pixel) const {
    return std::any_of(frames.begin(), frames.end(),
                       [&](const auto& frame) { return classes.IsTop(frame[pixel]); });
  }
};

Stack MakeStack(std::span<const PolarImage> images, const StillOptions& options) {
  const PolarImage& first = images.front();
  Stack stack{.classes = {options.display, first.scale.full_scale},
              .range_bins = first.value.rows(),
              .beams = first.value.cols(),
              .frames = {}};
  for (const PolarImage& image : images) {
    if (image.scale.quantity != Quantity::kGrey || image.scale.full_scale != first.scale.full_scale ||
        image.value.rows() != stack.range_bins || image.value.cols() != stack.beams) {
      throw DataError("still frames: the images differ in kind or size, or hold no grey levels");
    }
    std::vector<std::uint16_t>& frame = stack.frames.emplace_back();
    for (const float value : image.value.values()) {
      if (!std::isfinite(value)) throw DataError("still frames: a pixel is not finite");
      frame.push_back(static_cast<std::uint16_t>(stack.classes.Of(value)));
    }
  }
  const auto fits = [&](std::size_t size) { return size == 0 || size == stack.pixels(); };
  if (!fits(options.noise_shape_db.size()) || !fits(options.use.size())) {
    throw DataError("still frames: noise_shape_db or use has another size than the images");
  }
  return stack;
}

bool Counts(const StillOptions& options, std::size_t pixel) {
  return options.use.empty() || options.use[pixel] != 0;
}

double NoiseShapeDb(const StillOptions& options, std::size_t pixel) {
  return options.noise_shape_db.empty() ? 0.0 : options.noise_shape_db[pixel];
}

std::vector<std::size_t> BrightestPixels(const Stack& stack, const StillOptions& options) {
  std::vector<std::pair<double, std::size_t>> by_power;
  for (std::size_t pixel = 0; pixel < stack.pixels(); ++pixel) {
    if (Counts(options, pixel) && !stack.ReachesTop(pixel))
      by_power.emplace_back(-stack.MeanPower(pixel), pixel);
  }
  const auto share = static_cast<std::size_t>(kBrightestShare * static_cast<double>(by_power.size()));
  const std::size_t count = std::min(by_power.size(), std::max(kMinBright, share));
  std::partial_sort(by_power.begin(), by_power.begin() + static_cast<std::ptrdiff_t>(count), by_power.end());
  std::vector<std::size_t> brightest;
  for (std::size_t i = 0; i < count; ++i) brightest.push_back(by_power[i].second);
  return brightest;
}

[[noreturn]] void ThrowClipped() {
  throw DataError("still frames: every pixel is clipped at the top of the display");
}

// Finds the frames that differ from most others where those are brightest.
std::vector<bool> FindMoved(const Stack& stack, const StillOptions& options) {
  const std::vector<std::size_t> brightest = BrightestPixels(stack, options);
  if (brightest.empty()) ThrowClipped();
  const std::size_t count = stack.frames.size();
  std::vector<double> change(count, 0.0);
  std::vector<double> power(count);
  for (const std::size_t pixel : brightest) {
    for (std::size_t k = 0; k < count; ++k) power[k] = stack.classes.Power(stack.frames[k][pixel]);
    std::vector<double> sorted = power;
    std::sort(sorted.begin(), sorted.end());
    const double median = 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]);
    for (std::size_t k = 0; k < count; ++k)
      change[k] += median > 0.0 ? std::min(1.0, std::pow(power[k] / median - 1.0, 2)) : 1.0;
  }
  std::vector<bool> moved;
  moved.reserve(change.size());
  for (const double of_frame : change)
    moved.push_back(!(of_frame * options.looks < kMoved * static_cast<double>(brightest.size())));
  return moved;
}

// Every n-th of the pixels that determine the noise, with their likelihood.
struct Informative {
  std::vector<std::size_t> pixels;
  StillLikelihood likelihood;
};

Informative InformativePixels(const Stack& stack, const StillOptions& options, double noise_db,
                              std::size_t every) {
  const int frames = static_cast<int>(stack.frames.size());
  const double brightest_db = BrightestUsedDb(options.looks, frames, options.brightest_db);
  std::vector<std::size_t> pixels;
  std::vector<std::uint16_t> classes_of;
  std::vector<float> shape_db;
  for (std::size_t pixel = 0; pixel < stack.pixels(); pixel += every) {
    const double limit_db = noise_db + NoiseShapeDb(options, pixel) + brightest_db;
    if (!Counts(options, pixel) || !(stack.MeanPower(pixel) < PowerFromDb(limit_db))) continue;
    pixels.push_back(pixel);
    shape_db.push_back(static_cast<float>(NoiseShapeDb(options, pixel)));
    for (const auto& frame : stack.frames) classes_of.push_back(frame[pixel]);
  }
  if (pixels.empty()) throw DataError("still frames: no pixel is near the noise level");
  return {pixels, StillLikelihood(stack.classes, options.looks, frames, std::move(classes_of), shape_db,
                                  brightest_db)};
}

// If all pixels were noise, the darkest fifth would end a quarter of the mean below it.
double FirstLookDb(const Stack& stack, const StillOptions& options) {
  std::vector<double> levels_db;
  for (std::size_t pixel = 0; pixel < stack.pixels(); ++pixel) {
    if (!Counts(options, pixel)) continue;
    levels_db.push_back(DbFromPower(std::max(stack.MeanPower(pixel), sim::kSilencePower)) -
                        NoiseShapeDb(options, pixel));
  }
  const std::size_t rank = levels_db.size() / 5;
  return RankedValue(std::move(levels_db), rank);
}

// Log-likelihoods per pixel about the most likely level.
struct Profiles {
  double middle_db = 0.0;
  double step_db = 0.0;
  std::array<std::vector<double>, 3> by_pixel;  // at middle - step, middle, middle + step
  std::vector<double> weights;                  // weights of the echo amplitudes, at the middle
};

double Sum(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum;
}

Profiles Climb(const StillLikelihood& likelihood, double start_db, double step_db,
               const std::vector<double>& start_weights) {
  struct Point {
    std::vector<double> by_pixel;
    std::vector<double> weights;
    double sum = 0.0;
  };
  const auto at = [&](double noise_db) {
    Point point{.by_pixel = {}, .weights = start_weights};
    point.by_pixel = likelihood.Profile(noise_db, point.weights);
    point.sum = Sum(point.by_pixel);
    return point;
  };
  double middle_db = start_db;
  std::array<Point, 3> points = {at(start_db - step_db), at(start_db), at(start_db + step_db)};
  for (int step = 0; points[1].sum < std::max(points[0].sum, points[2].sum); ++step) {
    if (step == kMaxSteps) throw DataError("still frames: no noise level fits the changes");
    if (points[2].sum > points[0].sum) {
      middle_db += step_db;
      points = {std::move(points[1]), std::move(points[2]), at(middle_db + step_db)};
    } else {
      middle_db -= step_db;
      points = {at(middle_db - step_db), std::move(points[0]), std::move(points[1])};
    }
  }
  return {.middle_db = middle_db,
          .step_db = step_db,
          .by_pixel = {std::move(points[0].by_pixel), std::move(points[1].by_pixel),
                       std::move(points[2].by_pixel)},
          .weights = std::move(points[1].weights)};
}

int BlocksAcross(int beams, const StillOptions& options) {
  return (beams - 1) / options.block_beams + 1;
}

int BlockOf(std::size_t pixel, int beams, const StillOptions& options) {
  const int bin = static_cast<int>(pixel / beams) / options.block_bins;
  const int beam = static_cast<int>(pixel % beams) / options.block_beams;
  return bin * BlocksAcross(beams, options) + beam;
}

// Maximum of the parabola through the likelihoods of the pixels that `counts` selects, with its standard
// error from a sandwich over blocks.
struct Level {
  double db = 0.0;
  double sigma_db = 0.0;
};

template <typename Counts>
Level TopOf(const Profiles& profiles, const std::vector<int>& block_of, Counts&& counts) {
  const double h = profiles.step_db;
  struct Block {
    double slope = 0.0;
    double bend = 0.0;
  };
  std::map<int, Block> blocks;
  Block all;
  for (std::size_t i = 0; i < block_of.size(); ++i) {
    if (!counts(i)) continue;
    const double below = profiles.by_pixel[0][i];
    const double middle = profiles.by_pixel[1][i];
    const double above = profiles.by_pixel[2][i];
    Block& block = blocks[block_of[i]];
    block.slope += (above - below) / (2.0 * h);
    block.bend += (above - 2.0 * middle + below) / (h * h);
  }
  for (const auto& [index, block] : blocks) {
    all.slope += block.slope;
    all.bend += block.bend;
  }
  if (!(all.bend < 0.0)) return {profiles.middle_db, std::numeric_limits<double>::infinity()};
  const double move = -all.slope / all.bend;
  double scatter = 0.0;
  for (const auto& [index, block] : blocks) scatter += std::pow(block.slope + move * block.bend, 2);
  const auto n = static_cast<double>(blocks.size());
  return {.db = profiles.middle_db + move,
          .sigma_db = std::sqrt(scatter * n / std::max(1.0, n - 1.0)) / -all.bend};
}

// Variance of a sum over pixels with the speckle of one scene: half the squared differences of neighbouring
// blocks, between which the scene hardly changes.
double VarianceOfSum(const std::map<int, double>& by_block, int blocks_across) {
  double variance = 0.0;
  for (const auto& [block, sum] : by_block) {
    double of_block = 0.0;
    int neighbours = 0;
    for (const int other : {block - 1, block + 1}) {
      const auto found = by_block.find(other);
      if (found == by_block.end() || other / blocks_across != block / blocks_across) continue;
      of_block += 0.5 * std::pow(sum - found->second, 2);
      ++neighbours;
    }
    variance += neighbours == 0 ? sum * sum : of_block / neighbours;
  }
  return variance;
}

void FillEchoes(const Stack& stack, const StillOptions& options, const Informative& informative,
                const std::vector<double>& weights, StillLevels& levels) {
  std::vector<double>& power = levels.echo_power;
  power.assign(stack.pixels(), kUnknown);
  for (std::size_t pixel = 0; pixel < stack.pixels(); ++pixel) {
    if (!Counts(options, pixel)) continue;
    if (stack.ReachesTop(pixel)) {
      ++levels.clipped_at_top;
      continue;
    }
    // Pixels far above the noise, where the frames agree.
    power[pixel] = stack.MeanPower(pixel) - PowerFromDb(levels.noise_db + NoiseShapeDb(options, pixel));
  }
  const std::vector<double> near_noise = informative.likelihood.EchoPower(levels.noise_db, weights);
  for (std::size_t i = 0; i < near_noise.size(); ++i) {
    if (!std::isnan(power[informative.pixels[i]])) power[informative.pixels[i]] = near_noise[i];
  }
  std::map<int, double> by_block;
  double sum = 0.0;
  for (std::size_t pixel = 0; pixel < stack.pixels(); ++pixel) {
    if (std::isnan(power[pixel])) continue;
    ++levels.pixels;
    sum += power[pixel];
    by_block[BlockOf(pixel, stack.beams, options)] += power[pixel];
  }
  if (levels.pixels == 0) ThrowClipped();
  levels.echo_db = DbFromPower(sum / static_cast<double>(levels.pixels));
  levels.echo_sigma_db =
      DbFromPower(1.0 + std::sqrt(VarianceOfSum(by_block, BlocksAcross(stack.beams, options))) / sum);
}

}  // namespace

void StillOptions::Check() const {
  if (!(looks > 0.0)) throw DataError("still frames: looks is {:g}, expected more than 0", looks);
  if (block_bins < 1 || block_beams < 1)
    throw DataError("still frames: blocks of {} x {} pixels, expected 1 at least", block_bins, block_beams);
  if (!(brightest_db >= kMinBrightestDb && brightest_db <= 40.0)) {
    throw DataError("still frames: brightest_db is {:g}, expected {:g} .. 40", brightest_db, kMinBrightestDb);
  }
}

StillLevels SeparateSpeckleFromNoise(std::span<const PolarImage> images, std::span<const int> frame_numbers,
                                     const StillOptions& options) {
  options.Check();
  SONARCAL_CHECK(images.size() == frame_numbers.size(), "{} images, {} numbers", images.size(),
                 frame_numbers.size());
  if (images.size() < 2) throw DataError("still frames: {} given, expected at least two", images.size());
  Stack stack = MakeStack(images, options);
  StillLevels levels;
  levels.range_bins = stack.range_bins;
  levels.beams = stack.beams;
  const std::vector<bool> moved = FindMoved(stack, options);
  std::vector<std::vector<std::uint16_t>> still;
  for (std::size_t k = 0; k < moved.size(); ++k) {
    (moved[k] ? levels.moved : levels.frames).push_back(frame_numbers[k]);
    if (!moved[k]) still.push_back(std::move(stack.frames[k]));
  }
  if (still.size() < 2) {
    throw DataError(
        "frames {}: even their brightest pixels change from frame to frame as fresh speckle does, so that "
        "either the scene moves or nothing exceeds the noise",
        fmt::join(frame_numbers, ", "));
  }
  stack.frames = std::move(still);

  const std::size_t every = std::max<std::size_t>(1, stack.pixels() / kFirstLookPixels);
  double noise_db = FirstLookDb(stack, options);
  const Informative rough = InformativePixels(stack, options, noise_db, every);
  const Profiles first = Climb(rough.likelihood, noise_db, kFirstStepDb, {});
  noise_db = TopOf(first, std::vector<int>(rough.pixels.size(), 0), [](std::size_t) { return true; }).db;
  const Informative informative = InformativePixels(stack, options, noise_db, 1);
  const Profiles profiles = Climb(informative.likelihood, noise_db, kStepDb, first.weights);
  std::vector<int> block_of;
  for (const std::size_t pixel : informative.pixels) block_of.push_back(BlockOf(pixel, stack.beams, options));
  const Level noise = TopOf(profiles, block_of, [](std::size_t) { return true; });
  if (!std::isfinite(noise.sigma_db)) throw DataError("still frames: the noise level cannot be determined");
  levels.noise_db = noise.db;
  levels.noise_sigma_db = noise.sigma_db;
  FillEchoes(stack, options, informative, profiles.weights, levels);

  const Level bright = TopOf(profiles, block_of, [&](std::size_t i) {
    const std::size_t pixel = informative.pixels[i];
    return levels.echo_power[pixel] > PowerFromDb(noise.db + NoiseShapeDb(options, pixel) + kBrightDb);
  });
  if (bright.sigma_db < kBrightSigmaDb) {
    levels.bright_noise_db = bright.db;
    levels.bright_noise_sigma_db = bright.sigma_db;
  }
  return levels;
}

SceneEchoes CompareSceneEchoes(const StillLevels& levels, const std::vector<double>& expected_power,
                               const StillOptions& options, double above_noise_db) {
  SONARCAL_CHECK(expected_power.size() == levels.echo_power.size(), "{} expected powers of {} pixels",
                 expected_power.size(), levels.echo_power.size());
  SceneEchoes echoes;
  struct Block {
    double sum = 0.0;
    double count = 0.0;
  };
  std::map<int, Block> blocks;
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t pixel = 0; pixel < expected_power.size(); ++pixel) {
    const double noise_db = levels.noise_db + NoiseShapeDb(options, pixel);
    if (std::isnan(levels.echo_power[pixel])) continue;
    if (!(expected_power[pixel] >= PowerFromDb(noise_db + above_noise_db))) continue;
    const double ratio = levels.echo_power[pixel] / expected_power[pixel];
    sum += ratio;
    squares += ratio * ratio;
    echoes.expected_db += DbFromPower(expected_power[pixel]);
    ++echoes.pixels;
    Block& block = blocks[BlockOf(pixel, levels.beams, options)];
    block.sum += ratio;
    block.count += 1.0;
  }
  if (blocks.size() < 2) throw DataError("still frames: the scene's echoes hardly exceed the noise");
  const auto n = static_cast<double>(echoes.pixels);
  const double mean = sum / n;
  double scatter = 0.0;
  for (const auto& [index, block] : blocks) scatter += std::pow(block.sum - mean * block.count, 2);
  const auto b = static_cast<double>(blocks.size());
  echoes.expected_db /= n;
  echoes.measured_db = echoes.expected_db + DbFromPower(mean);
  echoes.sigma_db = DbFromPower(1.0 + std::sqrt(scatter * b / (b - 1.0)) / sum);
  echoes.contrast = std::sqrt(std::max(0.0, squares / n - mean * mean)) / mean;
  return echoes;
}

}  // namespace sonarcal::calib
