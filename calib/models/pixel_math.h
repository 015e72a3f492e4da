// Vectorised arithmetic of many pixels for a fit of the acoustic model. The formulas are those of
// calib/models/power_likelihood.h and sim/gathered/pixel_echoes.h. Tests compare the two.
//
// The source file is compiled in one version for any processor and one for AVX2, selected when the program
// starts. Infinities and NaN keep their meaning in both.
#pragma once

#include <cstdint>
#include <span>

#include "sim/gathered/ghost_echoes.h"
#include "sim/gathered/pixel_echoes.h"

namespace sonarcal::calib::pixel_math {

// Pixels to sum together: their sums stay in the first-level cache.
inline constexpr std::size_t kPixelsAtOnce = 64;

// Sums the echoes of each of `pixels`: kCurveStride values per material, with `curves` as in AddCurves.
// Overwrites `sums`, pixels x materials x kCurveStride.
void SumCurves(const sim::PixelEchoes& echoes, std::span<const std::uint32_t> pixels,
               std::span<const double> curves, double* sums);

// Adds ghosts to `sums`, and the power of each path to `by_way` (pixels x ways). `parts`: kCurveStride values
// per node, part and material. `passed`: a factor per path.
void AddGhosts(const sim::PixelEchoes& ghosts, std::span<const std::uint32_t> pixels,
               std::span<const double> parts, std::span<const double> passed, double* sums, double* by_way);

// As PowerLikelihood, for pixels that are not clipped. power >= 0, mean > 0.
void Likelihood(const double* power, const double* mean, int count, double looks, double* residual,
                double* slope);

// As ExpectedInformation, for a single look. 0 <= lowest < highest, which may be infinite; mean > 0.
void SingleLookInformation(double lowest, double highest, const double* mean, int count, double* information);

// Adds to `sum` (n x n, row-major, only the lower triangle is valid) the weighted outer products of `rows`
// (count x n), and to `projection` (n) the rows times `along`. Reads kRowPadding values beyond the end of
// `rows`.
inline constexpr int kRowPadding = 4;
void AddOuterProducts(const double* rows, const double* weight, const double* along, int count, int n,
                      double* sum, double* projection);

}  // namespace sonarcal::calib::pixel_math
