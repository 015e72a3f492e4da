// Constant false-alarm rate: a cell is object where its power (or grey level) is higher than that of the
// training cells around it (core/math/training_window.h) by more than chance allows.
//
//   cell averaging      against the mean of the training cells
//   ordered statistic   against their os_quantile, which a neighbouring object among them does not raise
//
// Made in polar coordinates, where a cell is a range bin of a beam and speckle has one grain everywhere.
//
// What is returned is the chance, in decades (metrics/segmentation/false_alarm.h), that background alone is
// as high: a cell is object where it has more decades than -log10 of the false-alarm rate. In power that rate
// holds where the background is even over the window, its pixels are independent and have `looks` looks
// (tests: within sampling error on exponential and Gamma noise). In grey it holds for logarithmic displays of
// any slope that clip little, with many training cells; elsewhere it is nominal. Where neighbouring pixels
// are alike, as an oversampled sonar's are, means of several pixels have fewer looks than is taken here, and
// more cells pass than is stated.
#pragma once

#include "core/types/image.h"
#include "core/types/mask.h"
#include "metrics/segmentation/segmentation_options.h"

namespace sonarcal::metrics {

// Of every pixel, in decades. `power`: received power, in any unit, 0 or more. options.method is kCaCfar or
// kOsCfar; the image has more cells than the guard covers, else a DataError. Pixels outside `valid` (the
// image's shape; null: all count) are no training cells; a pixel without a training cell has 0 decades.
Grid<float> CfarDecadesInPower(const Grid<float>& power, const SegmentationOptions& options,
                               const Mask* valid = nullptr);

// The same from grey levels. A spread below 1e-3 of full scale counts as that: a constant is no background.
Grid<float> CfarDecadesInGrey(const Grid<float>& grey, double full_scale, const SegmentationOptions& options,
                              const Mask* valid = nullptr);

}  // namespace sonarcal::metrics
