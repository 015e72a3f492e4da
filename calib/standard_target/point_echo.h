// The image of a point target about its peak, as a fit models it. Mean power of bin at range r and beam b:
//
//   10^((L + d - 40 log10 R - 2 alpha R + X log10(R / Rc) + s_b + TVG(r)) / 10)
//     el(phi) az(theta - theta_b) w(r - R) + n,
//
// with L the level of the target at 1 m (source level, gain and target strength together), s_b the
// sensitivity of the beam, and the responses of sim/physics/beam_pattern.h. Values of one frame: range R,
// azimuth theta, noise n, and d, by which its level differs from that of all frames. X is the
// part of the gain with range that the law TVG does not have.
#pragma once

#include <vector>

#include "core/types/image.h"
#include "core/types/parameters.h"
#include "sim/physics/beam_pattern.h"

namespace sonarcal::calib {

// Pixels about the peak of one frame.
struct EchoWindow {
  int frame = 0;  // in the recording
  std::vector<double> bin_range_m = {};
  std::vector<double> beam_azimuth_rad = {};
  int first_bin = 0;
  int first_beam = 0;
  std::vector<double> power = {};              // bins x beams, by bins
  std::vector<double> rounding_variance = {};  // likewise
  double elevation_rad = 0.0;
};

// Values that all frames share.
struct PointEcho {
  double level_db = 0.0;
  double log_azimuth_width = 0.0;  // of radians
  double azimuth_taper = 1.0;
  double log_pulse = 0.0;  // of metres
  double range_slope_db_per_decade = 0.0;
  double log_elevation_width = 0.0;  // of radians

  static constexpr int kSize = 6;
  double* data() { return &level_db; }
  const double* data() const { return &level_db; }
};
static_assert(sizeof(PointEcho) == PointEcho::kSize * sizeof(double));

struct FrameEcho {
  double range_m = 0.0;
  double azimuth_rad = 0.0;
  double log_noise = 0.0;        // of power
  double level_offset_db = 0.0;  // d

  static constexpr int kSize = 4;
  double* data() { return &range_m; }
  const double* data() const { return &range_m; }
};
static_assert(sizeof(FrameEcho) == FrameEcho::kSize * sizeof(double));

// Values that a fit does not change.
struct PointEchoSetting {
  double absorption_db_per_m = 0.0;
  TimeVariedGain time_varied_gain = TimeVariedGain::kNone;
  double reference_range_m = 1.0;  // Rc
  AzimuthPattern azimuth_pattern = AzimuthPattern::kAperture;
  ElevationPattern elevation_pattern = ElevationPattern::kCosine;
  double elevation_taper = 1.0;
  bool with_elevation = false;
};

sim::AzimuthResponse<double> AzimuthResponseOf(const PointEchoSetting& setting, const PointEcho& echo);

// Mean power of each pixel without noise, by bins. `sensitivity_db`: of the window's beams. `azimuth` is the
// response of `echo`: it takes longer to make than a window to compute.
std::vector<double> EchoPowerOf(const EchoWindow& window, const PointEchoSetting& setting,
                                const PointEcho& echo, const sim::AzimuthResponse<double>& azimuth,
                                const FrameEcho& frame, const std::vector<double>& sensitivity_db);

// Makes the response for one use.
std::vector<double> EchoPowerOf(const EchoWindow& window, const PointEchoSetting& setting,
                                const PointEcho& echo, const FrameEcho& frame,
                                const std::vector<double>& sensitivity_db);

// Variance of each pixel's power: a fixed echo and noise of mean power n add as fields, which gives n^2 +
// 2 n P. With that of rounding.
std::vector<double> VarianceOf(const EchoWindow& window, const std::vector<double>& echo_power, double noise);

}  // namespace sonarcal::calib
