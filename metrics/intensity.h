// Intensity error between a real and a simulated image: Park 2024, Section 6, Table 7 (0.23 .. 0.33 there).
//
// The paper gives no formula. It speaks of "the difference in the pixel value distribution", 0 for equal
// images, and reports a number between 0 and 1 for X-Y and R-theta images. Here:
//
//   difference d = (simulated - real) / full_scale                    of each pixel, so |d| <= 1
//   intensity error = mean of |d| over a domain
//
// over one of three domains, all of them reported:
//   union    pixels of either object region: the default. The paper compares object regions (Fig. 13), blames
//            the difference on noise and on the object's material, and its values have the size of this mean:
//            with its model and hand-set parameters, frames of a real sonar give 0.26 .. 0.30 over the union.
//   whole    the whole image (of a fan image: inside the fan). Mostly background: small for any dark image.
//   overlap  pixels of both regions: radiometry alone, blind to a wrong outline.
//
// A per-pixel error never reaches zero against a speckled image: see metrics/noise_floor.h for the floor.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "data_io/types/image.h"
#include "data_io/types/mask.h"

namespace sonarcal {

enum class IntensityDomain { kUnion, kWhole, kOverlap };

// "union", "whole", "overlap".
std::string_view ToString(IntensityDomain domain);

// Sums over pixels, of one frame or of several pooled; statistics have no value where there is no pixel.
struct DifferenceSums {
  std::int64_t pixels = 0;
  double absolute = 0.0;  // sum of |d|
  double square = 0.0;    // sum of d^2
  double signed_sum = 0.0;

  std::optional<double> mean_absolute() const;
  std::optional<double> mean_square() const;
  std::optional<double> rmse() const;
  std::optional<double> bias() const;  // positive: the simulated image is the brighter one

  void Add(double difference);
  DifferenceSums& operator+=(const DifferenceSums& other);
};

struct IntensityError {
  DifferenceSums union_region;
  DifferenceSums whole;
  DifferenceSums overlap;

  const DifferenceSums& Over(IntensityDomain domain) const;
  IntensityError& operator+=(const IntensityError& other);
};

// Everything of one shape; full_scale > 0; `inside` null: every pixel counts. Pixels outside count nowhere.
IntensityError MeasureIntensityError(const Grid<float>& real, const Grid<float>& simulated, double full_scale,
                                     const Mask& real_object, const Mask& simulated_object,
                                     const Mask* inside = nullptr);

}  // namespace sonarcal
