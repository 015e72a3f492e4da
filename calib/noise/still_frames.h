// Speckle told from receiver noise by frames of one pose whose scene stands still.
//
// From such a frame to the next the echo of a pixel, a field s, stays, speckle and all; receiver noise, of
// mean power N, is drawn anew. So the scatter of a pixel over the repeats is that of the noise, with variance
// (N^2 + 2 N |s|^2) / L at L looks (sim/physics/frozen_speckle.h), and what stays is the echo.
//
// N is found by maximum likelihood of the grey levels as they are: the chance of a level, clipped ends and
// rounding included, is a difference of that law's distribution function at the level's edges. How |s|^2 is
// spread over the pixels is not assumed but found with it, as weights of a row of amplitudes (by expectation
// maximisation). So there is no scene in it, no law of speckle, and no frozen speckle that is counted once a
// frame. Pixels far above the noise, which say little of it, are left out.
//
// Sigmas are those of a sandwich over blocks of pixels, within which speckle and noise are alike. That of the
// mean echo counts speckle once, however many repeats there are: it is told by neighbouring blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/types/image.h"
#include "core/types/parameters.h"

namespace sonarcal::calib {

struct StillOptions {
  DisplayParameters<double> display;
  double looks = 1.0;
  // By pixel, range_bins x beams: the noise level less what `noise_db` names, for a floor that is not the
  // same everywhere. Empty: it is.
  std::vector<double> noise_shape_db = {};
  std::vector<std::uint8_t> use = {};  // 1 for the pixels that count; empty: all
  int block_bins = 16;                 // pixels of a block
  int block_beams = 16;
  double brightest_db = 30.0;  // above the noise: brighter pixels do not tell of it

  // Throws DataError naming field, value and limit.
  void Check() const;
};

struct StillLevels {
  std::vector<int> frames;  // that stand still, numbered as given
  std::vector<int> moved;   // that do not, and were left out
  int range_bins = 0;
  int beams = 0;
  double noise_db = 0.0;
  double noise_sigma_db = 0.0;
  // What the pixels 13 dB and more above the noise say of it alone, where they say anything: higher where the
  // echoes themselves change a little.
  std::optional<double> bright_noise_db = {};
  double bright_noise_sigma_db = 0.0;
  // Mean power of the echoes over the pixels that count but for those clipped at the top.
  double echo_db = 0.0;
  double echo_sigma_db = 0.0;
  std::size_t pixels = 0;
  std::size_t clipped_at_top = 0;  // in any frame
  // By pixel: expectation of |s|^2, given the frames; NaN where it does not count or is clipped at the top.
  std::vector<double> echo_power;
};

// `frame_numbers` name the images in what is said of them. Frames whose brightest pixels are not those of the
// others are left out. Throws DataError where fewer than two stand still, as where even the brightest pixels
// change as fresh speckle does: then either the scene moves or nothing stands out of the noise.
StillLevels TellSpeckleFromNoise(std::span<const PolarImage> images, std::span<const int> frame_numbers,
                                 const StillOptions& options);

// The echoes that a scene is expected to give, against those that stand still: over the pixels where the
// expected power is at least `above_noise_db` over the noise. What is averaged is the ratio of the two
// powers, which is 1 in the mean whatever the law of the speckle; its logarithm would hang on the deepest
// fades, which nobody sees below the noise.
struct SceneEchoes {
  std::size_t pixels = 0;
  double expected_db = 0.0;  // mean level of the expected power
  double measured_db = 0.0;  // the same, plus the mean ratio as a level
  double sigma_db = 0.0;     // of the difference
  double contrast = 0.0;     // relative standard deviation of the ratio: 1 / sqrt(L) is developed speckle
};

inline constexpr double kWellAboveNoiseDb = 10.0;

// `expected_power` by pixel, without noise. Throws DataError where no two blocks hold such pixels.
SceneEchoes CompareSceneEchoes(const StillLevels& levels, const std::vector<double>& expected_power,
                               const StillOptions& options, double above_noise_db = kWellAboveNoiseDb);

}  // namespace sonarcal::calib
