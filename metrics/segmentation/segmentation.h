// Object against background: which pixels of an image the object occupies. Park 2024, Section 6, binarises
// real and simulated image without saying how, and warns that its occupancy figures depend on it. So the rule
// is written down here, applied to both images alike, and reported with every figure.
//
// The steps, in this order; a step whose parameter is zero is left out:
//   1. smooth: median (median_px), then Gaussian (blur_rows, blur_cols). Not for ca_cfar, os_cfar and
//      likelihood_ratio, whose rates of false alarms hold for pixels as received: they have cells of
//      cell_rows x cell_cols pixels in its place;
//   2. score, by `method` (metrics/segmentation/scored_image.h): the smoothed value, its contrast, or how
//   unlikely the
//      cell is under background; a pixel is object when its score is GREATER than the threshold;
//   3. tidy: opening, closing (rectangles), components dropped that are smaller than min_area_px or reach
//      further than max_rows or max_cols, largest one kept (8-connected; of equally large ones the first from
//      the top), holes or hulls filled.
//
// The defaults find the object in the frames of an ARIS 3000 with its speckle (tests/metrics holds two of
// them against each other: IoU 0.91). A blurred image's mask is wider than the object by about the blur.
//
// Pixels. `valid` are those that hold a measurement (of a fan image: inside the fan); `region` is where the
// object may be. Null means everywhere. Only valid pixels are looked at, and only valid pixels of the region
// can be object. Masks have the image's shape.
//
// Degenerate images, by rule: where no pixel may be object there is no object; where all values are equal (to
// within 1e-5 of full scale) all methods find none but fixed_threshold, which answers as ever, and
// likelihood_ratio, which knows the background. Values are finite; a valid pixel that is not is a DataError.
#pragma once

#include "core/types/image.h"
#include "core/types/mask.h"
#include "metrics/segmentation/region.h"
#include "metrics/segmentation/segmentation_options.h"

namespace sonarcal::metrics {

struct Segmentation {
  Mask object;             // the image's shape
  double threshold = 0.0;  // on the score: in the image's own unit; decades for methods with a stated rate
};

// Throws DataError where a valid pixel is not finite, where kOutsideRegion finds no pixel to learn from,
// where a contrast or a test is asked in dB or power of an image that does not state its dB scale, and where
// a method for polar images is given a fan.
Segmentation Segment(const Grid<float>& value, double full_scale, const SegmentationOptions& options,
                     const Mask* region = nullptr, const Mask* valid = nullptr);

Segmentation Segment(const PolarImage& image, const SegmentationOptions& options,
                     const Mask* region = nullptr, const Mask* valid = nullptr);
Segmentation Segment(const FanImage& image, const SegmentationOptions& options, const Mask* region = nullptr);

}  // namespace sonarcal::metrics
