// Fits the point echo of calib/standard_target/point_echo.h to the windows of all frames together.
//
// Residuals are recorded minus expected power over their standard deviation, which is taken from the last
// solution and renewed until nothing changes. The levels of frames differ by a normal law about their mean,
// whose standard deviation is estimated too: a target turns, swings and is crossed by bubbles.
//
// Standard errors are those of the linearised problem, with the values of each frame eliminated. Noise is
// correlated between pixels, so that a pixel counts for less than one. By how much is found from the frames:
// the scatter of their slopes of the cost by the shape of the echo, over what independent pixels would give.
// With fewer than kFramesForScatter frames, a resolution cell counts as one pixel. Few frames hardly show how
// much their levels differ, so Student's factor widens the standard error of the level.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/standard_target/point_echo.h"

namespace sonarcal::calib {

inline constexpr int kFramesForScatter = 5;

struct PointEchoFree {
  bool taper = true;
  bool range_slope = false;
  bool elevation_width = false;
};

struct PointEchoData {
  std::vector<EchoWindow> windows;
  PointEchoSetting setting;
  // Number of the free sensitivity of each beam of the sonar. Empty: none is free.
  std::vector<int> group_of_beam;
  int groups = 0;
  std::vector<double> sensitivity_db;  // of each beam of the sonar, if none is free; empty: 0
  double cell_pixels = 1.0;            // pixels of a resolution cell
  // Standard deviation of each pixel beyond noise, as a share of the largest expected power of its window. A
  // fit far from the optimum begins with a large share. Otherwise it may end at a local optimum with wrong
  // side lobes.
  double shape_error = 0.0;
};

struct PointEchoSolution {
  PointEcho echo;
  std::vector<FrameEcho> frames;  // one a window
  std::vector<double> group_db;   // mean 0
  double level_spread_db = 0.0;   // standard deviation of the frames' levels; 0 with fewer than three
  std::vector<double> frame_level_sigma_db;
  // Square of recorded minus expected power in each window, beyond what noise explains, over the square of
  // the echo's power.
  std::vector<double> misfit;
  // Covariance of PointEcho, then of group_db. Zero for values that are not free.
  Eigen::MatrixXd covariance;
  bool taper_at_bound = false;
  bool pulse_at_bound = false;
  double chi_square_per_pixel = 0.0;
  double inflation = 1.0;  // of the pixels' variances
  bool usable = false;
  int iterations = 0;
  double cost_initial = 0.0;
  double cost_final = 0.0;
  std::string termination;
};

// `start` gives the values to start from, and the level spread to start with.
PointEchoSolution FitPointEcho(const PointEchoData& data, const PointEchoFree& free,
                               const PointEchoSolution& start);

// Sensitivities of the window's beams.
std::vector<double> SensitivityOf(const PointEchoData& data, const std::vector<double>& group_db,
                                  const EchoWindow& window);

}  // namespace sonarcal::calib
