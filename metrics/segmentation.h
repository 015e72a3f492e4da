// Object against background: which pixels of an image the object occupies. Park 2024, Section 6, binarises
// real and simulated image without saying how, and warns that its occupancy figures depend on it. So the rule
// is written down here, applied to both images alike, and reported with every figure.
//
// The steps, in this order; a step whose parameter is zero is left out:
//   1. smooth: median (median_px), then Gaussian (blur_rows, blur_cols);
//   2. threshold, by `method`: a pixel is object when its smoothed value is GREATER than the threshold;
//   3. tidy: opening, closing (rectangles), components smaller than min_area_px dropped, largest one kept
//      (8-connected; of equally large ones the first from the top).
//
// The defaults find the object in the frames of an ARIS 3000 with its speckle (tests/metrics holds two of
// them against each other: IoU 0.91). A blurred image's mask is wider than the object by about the blur.
//
// Pixels. `valid` are those that hold a measurement (of a fan image: inside the fan); `region` is where the
// object may be. Null means everywhere. Only valid pixels are looked at, and only valid pixels of the region
// can be object. Masks have the image's shape.
//
// Degenerate images, by rule: where no pixel may be object there is no object; where all values are equal (to
// within 1e-5 of full scale) background_sigma and otsu find none, and fixed_threshold answers as ever. Values
// are finite; a valid pixel that is not is a DataError.
#pragma once

#include <string_view>

#include "data_io/types/image.h"
#include "data_io/types/mask.h"

namespace sonarcal {

enum class SegmentationMethod {
  // Threshold = background median + sigma_count standard deviations of the (smoothed) background, and at
  // least min_contrast above the median, so that a simulated image without noise has an object too.
  kBackgroundSigma,
  // Otsu 1979: the threshold that maximises the variance between the two classes, over the valid pixels of
  // the region. Meant for images in which object and background fill comparable areas.
  kOtsu,
  // threshold_fraction of full scale.
  kFixedThreshold,
};

// "background_sigma", "otsu", "fixed_threshold": the names used in metrics.json and on the command line.
std::string_view ToString(SegmentationMethod method);
// Throws UsageError naming the known methods.
SegmentationMethod SegmentationMethodFromString(std::string_view name);

// Where kBackgroundSigma learns what background is.
enum class BackgroundSample {
  kRobust,         // median and 1.4826 x median absolute deviation over the valid pixels of the region, of
                   // which the object must fill less than half
  kOutsideRegion,  // median and standard deviation over the valid pixels outside the region
};

std::string_view ToString(BackgroundSample sample);

struct SegmentationOptions {
  SegmentationMethod method = SegmentationMethod::kBackgroundSigma;

  BackgroundSample background = BackgroundSample::kRobust;  // kBackgroundSigma
  double sigma_count = 4.0;                                 // kBackgroundSigma; > 0
  double min_contrast = 1.0 / 255.0;                        // kBackgroundSigma; fraction of full scale, 0..1
  double threshold_fraction = 0.25;                         // kFixedThreshold; 0..1

  int median_px = 0;       // side of the median window: 0 (none), 3 or 5
  double blur_rows = 2.0;  // standard deviation of the Gaussian along rows (range bins); 0: none
  double blur_cols = 1.0;  // and along columns (beams)

  int open_rows = 0;    // height of the opening's rectangle; 0 or 1: none
  int open_cols = 0;    // and width
  int close_rows = 7;   // height of the closing's rectangle; 0 or 1: none
  int close_cols = 3;   // and width
  int min_area_px = 0;  // components with fewer pixels are dropped
  bool largest_component_only = true;

  // Throws DataError naming field, value and limit.
  void Check() const;
};

struct Segmentation {
  Mask object;             // the image's shape
  double threshold = 0.0;  // in the image's own unit
};

// Throws DataError where a valid pixel is not finite, or where kOutsideRegion finds no pixel to learn from.
Segmentation Segment(const Grid<float>& value, double full_scale, const SegmentationOptions& options,
                     const Mask* region = nullptr, const Mask* valid = nullptr);

Segmentation Segment(const PolarImage& image, const SegmentationOptions& options,
                     const Mask* region = nullptr);
Segmentation Segment(const FanImage& image, const SegmentationOptions& options, const Mask* region = nullptr);

// A region of interest: the bounding box of the object's pixels, wider by the margins on each side, cut at
// the image's borders. Nothing is set where the object has no pixel.
Mask BoxAround(const Mask& object, int margin_rows, int margin_cols);

}  // namespace sonarcal
