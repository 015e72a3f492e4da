// Cells that a scene does not explain: a fish, a rope, a wall that nobody drew. They count less in a fit, so
// that they do not bend it, and a map shows them.
//
// Speckle makes a single pixel say little, so cells are judged by their neighbourhood: with rho the mean of
// recorded over expected power in a window, of n independent pixels of L looks each,
//
//   z = (|10 log10 rho| - tolerance) / (4.34 dB / sqrt(n L)),
//
// is how many standard deviations of speckle it lies beyond what a model may be off by; the weight is 1 up to
// `sigmas`, and (sigmas / z)^2 beyond. Whatever the initial guess was, weights are taken about a finished
// fit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calib/models/power_likelihood.h"

namespace sonarcal::calib {

struct DownWeightOptions {
  double tolerance_db = 3.0;
  double sigmas = 4.0;
  // Extent of a grain of speckle in pixels: pulse length over bin, beam width over beam spacing. At least 1.
  double grain_bins = 1.0;
  double grain_beams = 1.0;

  // Throws DataError naming field, value and limit.
  void Check() const;
};

// One weight a pixel, 0..1, of a frame of bins x beams; `use` (1: counts; empty: all) takes pixels out of the
// windows. A pixel clipped at the bottom counts with the power at the clip.
std::vector<float> CellWeights(std::span<const RecordedPower> recorded, std::span<const double> mean,
                               std::span<const std::uint8_t> use, int bins, int beams, double looks,
                               const DownWeightOptions& options = {});

}  // namespace sonarcal::calib
