// An image as a method of segmentation sees it: a score for each pixel, and how a setting of the method
// becomes a threshold on it. Made once; any number of settings can then be tried (metrics/threshold_sweep.h).
//
//   method                                 setting                           chosen by
//   background_sigma                       standard deviations               sigma_count
//   fixed_threshold                        part of full scale                threshold_fraction
//   otsu, triangle                         part of full scale                the image
//   local_contrast                         part of full scale                contrast or contrast_db
//   ca_cfar, os_cfar, likelihood_ratio     -log10 of the false-alarm rate    false_alarm_rate
#pragma once

#include <optional>
#include <string_view>

#include "core/types/image.h"
#include "core/types/mask.h"
#include "metrics/segmentation/segmentation_options.h"

namespace sonarcal::metrics {

// "standard deviations", "part of full scale", "-log10 of the false-alarm rate".
std::string_view SettingUnit(SegmentationMethod method);

class ScoredImage {
 public:
  // Throws DataError where a valid pixel is not finite, where the method cannot be applied (metrics/
  // segmentation.h), or an option is out of range. Region and valid: the image's shape, or null.
  ScoredImage(const Grid<float>& value, const ImageScale& scale, const SegmentationOptions& options,
              const Mask* region, const Mask* valid);

  double setting() const { return setting_; }
  double ThresholdAt(double setting) const;

  // Whether a pixel may be object at all: else no threshold finds one.
  bool any_pixel() const { return any_pixel_; }

  // The object: what scores more than `threshold` and may be object, tidied (metrics/segmentation/tidy.h).
  // `within` (the image's shape; null: everywhere) limits it further; what the image tells of a threshold it
  // leaves alone.
  Mask ObjectAbove(double threshold, const Mask* within = nullptr) const;

 private:
  SegmentationOptions options_;
  Grid<float> score_;
  Mask may_be_object_;
  bool any_pixel_ = false;
  double setting_ = 0.0;
  // A threshold is offset_ + max(setting x unit_, least_).
  double offset_ = 0.0;
  double unit_ = 1.0;
  double least_ = 0.0;
  std::optional<double> chosen_;  // the threshold at setting(), where the image says it
};

}  // namespace sonarcal::metrics
