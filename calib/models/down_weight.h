// Reduced weight of pixels that do not match the scene, such as a fish, a rope or a missing wall. They bend
// the fit less, and a map shows them.
//
// Because of speckle a single pixel has little information, so a pixel is tested by its neighbourhood. With
// rho the mean of recorded over expected power in a window of n independent pixels of L looks each,
//
//   z = (|10 log10 rho| - tolerance) / (4.34 dB / sqrt(n L))
//
// is the number of standard deviations of speckle by which it exceeds the tolerance of the model. The weight
// is 1 up to z = `sigmas`, and (sigmas / z)^2 beyond. Weights are computed about a finished fit, so that they
// do not depend on the initial guess.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calib/models/power_likelihood.h"

namespace sonarcal::calib {

struct DownWeightOptions {
  double tolerance_db = 3.0;
  double sigmas = 4.0;
  // Size of a speckle cell in pixels: pulse length / bin, beam width / beam spacing. At least 1.
  double cell_bins = 1.0;
  double cell_beams = 1.0;

  // Throws DataError with field, value and limit.
  void Check() const;
};

// Returns one weight per pixel, 0..1, for a frame of bins x beams. `use` (1: used; empty: all) excludes
// pixels from the windows. A pixel clipped at the bottom has the power at the clip.
std::vector<float> CellWeights(std::span<const RecordedPower> recorded, std::span<const double> mean,
                               std::span<const std::uint8_t> use, int bins, int beams, double looks,
                               const DownWeightOptions& options = {});

}  // namespace sonarcal::calib
