// Segmentation: finds the pixels of an image that the object occupies. Park 2024, Section 6, binarises real
// and simulated images without giving the method, and warns that its occupancy figures depend on it. The rule
// here is therefore documented, applied to both images alike, and reported with every figure.
//
// Steps, in this order; a step whose parameter is zero is omitted:
//
//   1. Smooth: median (median_px), then Gaussian (blur_rows, blur_cols). Not for ca_cfar, os_cfar and
//      likelihood_ratio: their false-alarm rates hold for pixels as received. They average over cells of
//      cell_rows x cell_cols pixels instead.
//   2. Score, by `method` (metrics/segmentation/scored_image.h): the smoothed value, its contrast, or the
//      improbability of the cell under background. A pixel is object if its score is GREATER than the
//      threshold.
//   3. Tidy: opening, closing (rectangles); components removed that are smaller than min_area_px or larger
//      than max_rows or max_cols; largest one kept (8-connected; of equally large ones the first from the
//      top); holes or hulls filled.
//
// The defaults find the object in frames of an ARIS 3000 with its speckle (tests/metrics compares two of
// them: IoU 0.91). The mask of a blurred image is wider than the object by about the blur.
//
// Pixels: `valid` pixels hold a measurement (of a fan image: inside the fan); `region` limits where the
// object may be. Null means everywhere. Only valid pixels are read, and only valid pixels of the region can
// be object. Masks have the image's shape.
//
// Degenerate images: if no pixel may be object, there is no object. If all values are equal (to within 1e-5
// of full scale), no method finds an object, except fixed_threshold, which works as usual, and
// likelihood_ratio, which knows the background. Values must be finite; a valid pixel that is not throws
// DataError.
#pragma once

#include "core/types/image.h"
#include "core/types/mask.h"
#include "metrics/segmentation/region.h"
#include "metrics/segmentation/segmentation_options.h"

namespace sonarcal::metrics {

struct Segmentation {
  Mask object;  // has the image's shape
  // threshold on the score: in the image's own unit; decades for methods with a false-alarm rate
  double threshold = 0.0;
};

// Throws DataError if a valid pixel is not finite; if kOutsideRegion has no pixel to learn from; if a
// contrast in dB or a test in power needs a dB scale that the image does not state; or if a method for polar
// images gets a fan.
Segmentation Segment(const Grid<float>& value, double full_scale, const SegmentationOptions& options,
                     const Mask* region = nullptr, const Mask* valid = nullptr);

Segmentation Segment(const PolarImage& image, const SegmentationOptions& options,
                     const Mask* region = nullptr, const Mask* valid = nullptr);
Segmentation Segment(const FanImage& image, const SegmentationOptions& options, const Mask* region = nullptr);

}  // namespace sonarcal::metrics
