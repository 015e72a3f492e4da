// Constant false-alarm rate (CFAR): a cell is object if its power (or grey level) exceeds that of the
// training cells around it (core/math/training_window.h) by more than chance allows.
//
//   cell averaging     compares with the mean of the training cells
//   ordered statistic  compares with their os_quantile, which a neighbouring object does not raise
//
// Works in polar coordinates, in which a cell is a range bin of a beam and speckle cells have one size
// everywhere.
//
// Results are false-alarm probabilities in decades (metrics/segmentation/false_alarm.h): the probability that
// background alone is as high. A cell is object if it has more decades than -log10 of the false-alarm rate.
// In power, that rate is exact if the background is uniform over the window and its pixels are independent
// with `looks` looks (tests: within the sampling error on exponential and Gamma noise). In grey, it is exact
// for logarithmic displays of any slope with little clipping and many training cells; otherwise it is
// nominal. If neighbouring pixels are correlated, as in an oversampled sonar, means of several pixels have
// fewer looks than assumed, and the real rate is higher.
#pragma once

#include "core/types/image.h"
#include "core/types/mask.h"
#include "metrics/segmentation/segmentation_options.h"

namespace sonarcal::metrics {

// Decades of every pixel. `power`: received power, in any unit, >= 0. options.method is kCaCfar or kOsCfar.
// Throws DataError if the guard covers the whole image. Pixels outside `valid` (the image's shape; null: all
// are valid) are not training cells. A pixel without a training cell has 0 decades.
Grid<float> CfarDecadesInPower(const Grid<float>& power, const SegmentationOptions& options,
                               const Mask* valid = nullptr);

// Decades from grey levels. A spread below 1e-3 of full scale is replaced by this value, because a constant
// image has no background statistics.
Grid<float> CfarDecadesInGrey(const Grid<float>& grey, double full_scale, const SegmentationOptions& options,
                              const Mask* valid = nullptr);

}  // namespace sonarcal::metrics
