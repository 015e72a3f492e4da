// Echoes as a display with a threshold shows them: their number, and how many lie where the other image has
// one. The definitions are those of viam-labs/synthetic-sonar-eval (compare_1d, compare_components):
//
//   echo                a pixel above the echo level, which is the same for both images
//   coverage ratio      share of echoes in the simulated image / share in the real one; 1 is best
//   matched echo mass   share of one image's echoes with an echo of the other image within the tolerance;
//                       1 is best. `matched_real` is a recall, `matched_simulated` a precision.
//
// Mass counts pixels, not intensities. Differences from that project: it reads the echo level from the legend
// of its display, here it is Otsu's threshold of the real image, which needs no legend. Its tolerance is 6
// pixels of a 926-pixel picture, here it is 2 pixels of the view. Both choices change the value, so compare
// it with its noise floor and with values of the same settings only.
#pragma once

#include <cstdint>
#include <optional>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::metrics {

inline constexpr int kEchoTolerancePx = 2;  // distance between pixel centres

// Counts of pixels, of one frame or of several pooled.
struct EchoCounts {
  std::int64_t real = 0;
  std::int64_t simulated = 0;
  std::int64_t real_near_simulated = 0;  // echoes of the real image with a simulated one nearby
  std::int64_t simulated_near_real = 0;

  // None if the image in the denominator has no echo.
  std::optional<double> coverage_ratio() const;
  std::optional<double> matched_real() const;
  std::optional<double> matched_simulated() const;

  EchoCounts& operator+=(const EchoCounts& other);
};

// Otsu's threshold of the real image; infinite if no pixel is inside. `inside` null: every pixel counts.
double EchoLevel(const Grid<float>& real, const Mask* inside = nullptr);

// All arrays have one shape. Pixels that are not inside hold no echo.
EchoCounts CountEchoes(const Grid<float>& real, const Grid<float>& simulated, double echo_level,
                       const Mask* inside = nullptr);

}  // namespace sonarcal::metrics
