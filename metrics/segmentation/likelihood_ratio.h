// A cell against the fitted law of the background (metrics/segmentation/background_law.h): is the mean power
// m of its n pixels, each over the law's mean power there, that of the background (1) or a larger one,
// whatever its size?
//
// The generalised likelihood ratio of the two, Gamma distributed with L looks, is
//   ln ratio = n L (m - 1 - ln m)   for m > 1, else 0,
// with m the maximum-likelihood estimate of that mean. It rises with m, of which the law under background is
// known: n L looks. So a rate of false alarms can be stated: returned is the chance, in decades
// (metrics/segmentation/false_alarm.h), that background alone is as high.
//
// That rate holds where the law does, as far as pixels are independent and few are clipped; grey levels are
// steps of power, so that a rate is met to within a level.
#pragma once

#include "core/types/image.h"
#include "core/types/mask.h"
#include "metrics/segmentation/background_law.h"

namespace sonarcal::metrics {

// Of every pixel, in decades; cells of cell_rows x cell_cols pixels, both odd. Pixels outside `valid` (null:
// all count) have no part in any cell. Throws DataError where the law was made for an image of another shape,
// or where it is not as its type says.
Grid<float> LikelihoodDecades(const Grid<float>& grey, double full_scale, const BackgroundLaw& law,
                              int cell_rows, int cell_cols, const Mask* valid = nullptr);

}  // namespace sonarcal::metrics
