// Intensity error between a real and a simulated image: Park 2024, Section 6, Table 7 (0.23 .. 0.33 there).
//
// The paper gives no formula. It refers to "the difference in the pixel value distribution", 0 for equal
// images, and reports a number between 0 and 1 for X-Y and R-theta images. Definition used here:
//
//   difference d = (simulated - real) / full_scale    of each pixel, so |d| <= 1
//   intensity error = mean of |d| over a domain
//
// Domains, all of them reported:
//
//   union    Pixels of either object region; the default. The paper compares object regions (Fig. 13) and
//            attributes the difference to noise and to the object's material. Its values have the size of
//            this mean: with its model and hand-set parameters, frames of a real sonar give 0.26 .. 0.30.
//   whole    The whole image (of a fan image: inside the fan). Mostly background: small for any dark image.
//   overlap  Pixels of both regions: radiometry only, not sensitive to a wrong outline.
//
// Other interpretations of the paper's sentence are measured too: the error relative to the recorded level,
// the difference of the two objects' mean levels, half the L1 distance of the two histograms
// (metrics/measures/level_histograms.h).
//
// A per-pixel error never reaches zero for a speckled image; metrics/noise_floor.h gives its floor.
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

// Sums over pixels, of one frame or of several pooled. r is the recorded value and s the simulated value, as
// fractions of full scale; d = s - r. Without pixels, statistics have no value.
struct DifferenceSums {
  std::int64_t pixels = 0;
  double absolute = 0.0;  // sum of |d|
  double square = 0.0;    // sum of d^2
  double signed_sum = 0.0;
  double real = 0.0;  // sum of r; the following members likewise
  double real_square = 0.0;
  double simulated = 0.0;
  double simulated_square = 0.0;
  double product = 0.0;  // sum of r s

  std::optional<double> mean_absolute() const;
  std::optional<double> mean_square() const;
  std::optional<double> rmse() const;
  std::optional<double> bias() const;  // positive: the simulated image is brighter

  // Sum of |d| divided by sum of r: the error relative to the recorded level. None if the sum of r is 0.
  std::optional<double> relative() const;
  // Zero-mean normalised cross-correlation (NCC, Pearson's r) of the two images, -1 .. 1. Does not depend on
  // gain and offset. None if either image is constant.
  std::optional<double> correlation() const;

  void Add(double real_value, double simulated_value);
  DifferenceSums& operator+=(const DifferenceSums& other);
};

// Peak signal-to-noise ratio in dB: 10 log10(1 / mean square) of differences in fractions of full scale. None
// for equal images.
std::optional<double> PsnrDb(double mean_square);

// Levels of each image in its own object region. Their means are compared, not their pixels.
struct ObjectLevels {
  std::int64_t real_pixels = 0;
  double real = 0.0;  // sum of r over the recorded object
  std::int64_t simulated_pixels = 0;
  double simulated = 0.0;

  // |mean s - mean r|; none if either region is empty.
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

// All arrays have one shape; full_scale > 0. `inside` null: every pixel counts, otherwise only pixels inside.
IntensityError MeasureIntensityError(const Grid<float>& real, const Grid<float>& simulated, double full_scale,
                                     const Mask& real_object, const Mask& simulated_object,
                                     const Mask* inside = nullptr);

}  // namespace sonarcal::metrics
