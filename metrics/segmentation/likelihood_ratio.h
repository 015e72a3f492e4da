// Tests a cell against the fitted distribution of the background (metrics/segmentation/background_law.h). m
// is the mean power of the cell's n pixels, each divided by the background's mean power there. The hypotheses
// are that the expectation of m is 1 (background), or larger.
//
// Their generalised likelihood ratio, with L looks per pixel, is
//   ln ratio = n L (m - 1 - ln m)   for m > 1, else 0,
// because m is the maximum-likelihood estimate of its expectation. The ratio increases with m, whose
// distribution under background is known (n L looks). The result is therefore a false-alarm probability in
// decades (metrics/segmentation/false_alarm.h).
//
// The rate is exact if the distribution is, pixels are independent and few are clipped. Grey levels are steps
// of power, so a rate is met to within one level.
#pragma once

#include "core/types/image.h"
#include "core/types/mask.h"
#include "metrics/segmentation/background_law.h"

namespace sonarcal::metrics {

// Decades of every pixel, for cells of cell_rows x cell_cols pixels, both odd. Pixels outside `valid` (null:
// all are valid) belong to no cell. Throws DataError if `law` has another shape or invalid values.
Grid<float> LikelihoodDecades(const Grid<float>& grey, double full_scale, const BackgroundLaw& law,
                              int cell_rows, int cell_cols, const Mask* valid = nullptr);

}  // namespace sonarcal::metrics
