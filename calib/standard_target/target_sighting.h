// Finds a small target in an image: the brightest echo that stands alone above the noise.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/types/image.h"
#include "core/types/parameters.h"

namespace sonarcal::calib {

// Received powers of a frame, range_bins x beams.
struct ReceivedPowers {
  Grid<double> power;  // half the limit where the display shows no echo as weak
  // Variance of what rounding to a grey level adds.
  Grid<double> rounding_variance;
  Grid<std::uint8_t> clipped;  // 1: at the top of the display
};

// Throws DataError if the image does not hold grey levels.
ReceivedPowers PowersOf(const PolarImage& image, const DisplayParameters<double>& display);

struct TargetSearch {
  std::optional<double> range_min_m = {};  // absent: all
  std::optional<double> range_max_m = {};
  // Peak over the mean noise of its ranges.
  double above_noise_db = 13.0;
};

struct TargetSighting {
  int bin = 0;
  int beam = 0;
  double peak_power = 0.0;
  double noise_power = 0.0;  // mean, in the other beams at the same ranges
  // Extent at half of the peak.
  double range_extent_m = 0.0;
  double azimuth_extent_rad = 0.0;
};

struct TargetSearchResult {
  std::optional<TargetSighting> sighting = {};
  std::string why_not = {};  // without a sighting, such as "its echo is clipped"
  std::string detail = {};   // what this image shows
};

// Returns the brightest local peak that falls to a tenth on every side within a few times its own extent, so
// that surfaces are passed over. Needs at least three beams.
TargetSearchResult FindTarget(const ReceivedPowers& image, const PolarAxes& axes, const TargetSearch& search);

}  // namespace sonarcal::calib
