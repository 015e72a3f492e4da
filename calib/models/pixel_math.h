// The arithmetic of many pixels at once, as fast as the processor's vectors make it: what a fit of the
// acoustic model does for each of its million pixels. The formulas are those of
// calib/models/power_likelihood.h and sim/gathered/pixel_echoes.h, stated there; here they are only
// evaluated, and the tests hold the two against each other.
//
// This file's source is compiled in one version for any processor and one for those with AVX2, chosen when
// the program starts. Infinities and NaN keep their meaning in both.
#pragma once

#include <cstdint>
#include <span>

#include "sim/gathered/ghost_echoes.h"
#include "sim/gathered/pixel_echoes.h"

namespace sonarcal::calib::pixel_math {

// For each of `pixels`, its echoes' sums: kCurveStride values for each material, of `curves` as in AddCurves.
// sums: pixels x materials x kCurveStride, set whole.
void SumCurves(const sim::PixelEchoes& echoes, std::span<const std::uint32_t> pixels,
               std::span<const double> curves, double* sums);

// Adds to `sums` what ghosts bring, and to `by_way` (pixels x ways) the power of each way: `parts` holds
// kCurveStride values for each node of each part of each material, `passed` a factor for each way.
void AddGhosts(const sim::PixelEchoes& ghosts, std::span<const std::uint32_t> pixels,
               std::span<const double> parts, std::span<const double> passed, double* sums, double* by_way);

// PowerLikelihood of pixels that are not clipped. power >= 0, mean > 0.
void Likelihood(const double* power, const double* mean, int count, double looks, double* residual,
                double* slope);

// ExpectedInformation of a single look. 0 <= lowest < highest, which may be infinite; mean > 0.
void SingleLookInformation(double lowest, double highest, const double* mean, int count, double* information);

// Adds to sum (n x n, row by row; its lower triangle is what counts) the weighted outer products of rows
// (count x n), and to projection (n) the rows times `along`. Of `rows`, kRowPadding values more are read.
inline constexpr int kRowPadding = 4;
void AddOuterProducts(const double* rows, const double* weight, const double* along, int count, int n,
                      double* sum, double* projection);

}  // namespace sonarcal::calib::pixel_math
