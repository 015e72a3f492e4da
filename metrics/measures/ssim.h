// Structural similarity (SSIM), Wang, Bovik, Sheikh & Simoncelli, IEEE Trans. Image Process. 13(4), 2004, Eq.
// 13, with the paper's settings: a Gaussian window of 11 x 11 pixels and standard deviation 1.5, C1 = (0.01
// L)^2, C2 = (0.03 L)^2, L the full scale, and only windows that lie completely inside the image.
//
//   SSIM(x, y) = (2 mx my + C1)(2 sxy + C2) / ((mx^2 + my^2 + C1)(sx^2 + sy^2 + C2)),   -1 .. 1, 1 is best
//
// A polar image is evaluated in bins and beams. Independent speckle has no common structure: two looks at one
// uniform scene give almost 0, although no simulation could do better. Compare the value with its noise
// floor.
#pragma once

#include <cstdint>
#include <optional>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::metrics {

inline constexpr int kSsimWindowPx = 11;
inline constexpr double kSsimSigmaPx = 1.5;

// Sum of SSIM over windows, of one frame or of several pooled.
struct SsimSum {
  std::int64_t windows = 0;
  double sum = 0.0;

  std::optional<double> mean() const;
  SsimSum& operator+=(const SsimSum& other);
};

struct StructuralSimilarity {
  SsimSum whole;         // every window
  SsimSum union_region;  // windows whose centre lies in either object region

  StructuralSimilarity& operator+=(const StructuralSimilarity& other);
};

// All arrays have one shape; full_scale > 0. `inside` null: every pixel counts, otherwise only windows
// inside. An image of fewer than 11 rows or columns has no window.
StructuralSimilarity MeasureSsim(const Grid<float>& real, const Grid<float>& simulated, double full_scale,
                                 const Mask& real_object, const Mask& simulated_object,
                                 const Mask* inside = nullptr);

}  // namespace sonarcal::metrics
