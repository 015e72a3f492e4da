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
// Other readings of the sentence are measured beside it: relative to the recorded level, the difference of
// the two objects' mean levels, half the L1 distance of the two histograms
// (metrics/measures/level_histograms.h).
//
// A per-pixel error never reaches zero against a speckled image: see metrics/noise_floor.h for the floor.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>

#include "core/types/image.h"
#include "core/types/mask.h"
#include "core/types/words.h"

namespace sonarcal::metrics {

enum class IntensityDomain { kUnion, kWhole, kOverlap };
constexpr auto WordsOf(std::type_identity<IntensityDomain>) {
  return Words<IntensityDomain, 3>{{{"union", IntensityDomain::kUnion},
                                    {"whole", IntensityDomain::kWhole},
                                    {"overlap", IntensityDomain::kOverlap}}};
}

// Sums over pixels, of one frame or of several pooled, of the recorded value r and the simulated value s as
// fractions of full scale, d = s - r. Statistics have no value where there is no pixel.
struct DifferenceSums {
  std::int64_t pixels = 0;
  double absolute = 0.0;  // sum of |d|
  double square = 0.0;    // sum of d^2
  double signed_sum = 0.0;
  double real = 0.0;  // sum of r, and so on
  double real_square = 0.0;
  double simulated = 0.0;
  double simulated_square = 0.0;
  double product = 0.0;  // sum of r s

  std::optional<double> mean_absolute() const;
  std::optional<double> mean_square() const;
  std::optional<double> rmse() const;
  std::optional<double> bias() const;  // positive: the simulated image is the brighter one

  // Sum of |d| over sum of r: the error beside the recorded level. None where nothing was recorded.
  std::optional<double> relative() const;
  // Zero-mean normalised cross-correlation (NCC, Pearson's r) of the two images, -1 .. 1: blind to gain and
  // offset. None where either image is even.
  std::optional<double> correlation() const;

  void Add(double real_value, double simulated_value);
  DifferenceSums& operator+=(const DifferenceSums& other);
};

// Peak signal-to-noise ratio in dB, 10 log10(1 / mean square) of differences in fractions of full scale. None
// for images that do not differ.
std::optional<double> PsnrDb(double mean_square);

// Of each image its own object region: their means are compared, not their pixels.
struct ObjectLevels {
  std::int64_t real_pixels = 0;
  double real = 0.0;  // sum over the recorded object of r
  std::int64_t simulated_pixels = 0;
  double simulated = 0.0;

  // |mean s - mean r|, none where either region is empty.
  std::optional<double> mean_difference() const;
  ObjectLevels& operator+=(const ObjectLevels& other);
};

struct IntensityError {
  DifferenceSums union_region;
  DifferenceSums whole;
  DifferenceSums overlap;
  ObjectLevels objects;

  const DifferenceSums& Over(IntensityDomain domain) const;
  IntensityError& operator+=(const IntensityError& other);
};

// Everything of one shape; full_scale > 0; `inside` null: every pixel counts. Pixels outside count nowhere.
IntensityError MeasureIntensityError(const Grid<float>& real, const Grid<float>& simulated, double full_scale,
                                     const Mask& real_object, const Mask& simulated_object,
                                     const Mask* inside = nullptr);

}  // namespace sonarcal::metrics
