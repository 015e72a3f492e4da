// Separates speckle from receiver noise by frames from one pose of a static scene.
//
// The echo of a pixel, a field s, stays the same from frame to frame, including speckle. Receiver noise of
// mean power N changes. So the scatter of a pixel over the frames is that of the noise, with variance (N^2 +
// 2 N |s|^2) / L at L looks (sim/physics/frozen_speckle.h), and the constant part is the echo.
//
// N is found by maximum likelihood of the recorded grey levels. The probability of a level, including
// clipping and rounding, is a difference of the distribution function at the edges of the level. The
// distribution of |s|^2 over the pixels is not assumed. It is estimated too, as weights of a series of
// amplitudes (expectation maximisation). So the result depends on no scene and no law of speckle, and does
// not count frozen speckle once per frame. Pixels far above the noise are left out, because they have little
// information on it.
//
// Standard errors come from a sandwich over blocks of pixels, within which speckle and noise are correlated.
// That of the mean echo counts speckle once for any number of frames; it comes from neighbouring blocks.
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
  // Noise level of each pixel minus `noise_db`, range_bins x beams, for a floor that is not constant. Empty:
  // 0.
  std::vector<double> noise_shape_db = {};
  std::vector<std::uint8_t> use = {};  // 1 for used pixels; empty: all
  int block_bins = 16;                 // size of a block in pixels
  int block_beams = 16;
  double brightest_db = 30.0;  // above the noise; brighter pixels are left out

  // Throws DataError with field, value and limit.
  void Check() const;
};

struct StillLevels {
  std::vector<int> frames;  // static frames, with their given numbers
  std::vector<int> moved;   // frames that differ and were left out
  int range_bins = 0;
  int beams = 0;
  double noise_db = 0.0;
  double noise_sigma_db = 0.0;
  // Noise level from the pixels at least 13 dB above the noise alone, if they determine it. It is higher if
  // the echoes themselves change a little.
  std::optional<double> bright_noise_db = {};
  double bright_noise_sigma_db = 0.0;
  // Mean power of the echoes over the used pixels, except those clipped at the top.
  double echo_db = 0.0;
  double echo_sigma_db = 0.0;
  std::size_t pixels = 0;
  std::size_t clipped_at_top = 0;  // in any frame
  // Expectation of |s|^2 per pixel, given the frames; NaN if the pixel is not used or is clipped at the top.
  std::vector<double> echo_power;
};

// `frame_numbers`: numbers of the images for messages. Leaves out frames whose brightest pixels differ from
// those of the others. Throws DataError if fewer than two frames are static. This includes the case that even
// the brightest pixels change like fresh speckle: the scene moves, or nothing exceeds the noise.
StillLevels SeparateSpeckleFromNoise(std::span<const PolarImage> images, std::span<const int> frame_numbers,
                                     const StillOptions& options);

// Compares the echoes that a scene predicts with the constant echoes of the frames, over the pixels where the
// predicted power is at least `above_noise_db` above the noise. Averages the ratio of the two powers, whose
// mean is 1 for any law of speckle. The mean of its logarithm would depend on the deepest fades, which are
// hidden in the noise.
struct SceneEchoes {
  std::size_t pixels = 0;
  double expected_db = 0.0;  // mean level of the expected power
  double measured_db = 0.0;  // expected_db plus the mean ratio as a level
  double sigma_db = 0.0;     // of measured_db - expected_db
  double contrast = 0.0;     // relative standard deviation of the ratio; 1 / sqrt(L) for developed speckle
};

inline constexpr double kWellAboveNoiseDb = 10.0;

// `expected_power`: per pixel, without noise. Throws DataError if fewer than two blocks hold such pixels.
SceneEchoes CompareSceneEchoes(const StillLevels& levels, const std::vector<double>& expected_power,
                               const StillOptions& options, double above_noise_db = kWellAboveNoiseDb);

}  // namespace sonarcal::calib
