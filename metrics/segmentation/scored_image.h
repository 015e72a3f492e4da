// Scores of an image for one segmentation method, and the conversion of a setting to a threshold on the
// score. Computed once; then any number of settings can be applied (metrics/threshold_sweep.h).
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
  // Throws DataError if a valid pixel is not finite, the method cannot be applied
  // (metrics/segmentation/segmentation.h), or an option is out of range. Region and valid have the image's
  // shape, or are null.
  ScoredImage(const Grid<float>& value, const ImageScale& scale, const SegmentationOptions& options,
              const Mask* region, const Mask* valid);

  double setting() const { return setting_; }
  double ThresholdAt(double setting) const;

  // False if no pixel may be object; then no threshold finds one.
  bool any_pixel() const { return any_pixel_; }

  // Object mask: pixels that may be object with a score above `threshold`, tidied
  // (metrics/segmentation/tidy.h). `within` (the image's shape; null: everywhere) limits the mask further,
  // but has no effect on thresholds that depend on the image.
  Mask ObjectAbove(double threshold, const Mask* within = nullptr) const;

 private:
  SegmentationOptions options_;
  Grid<float> score_;
  Mask may_be_object_;
  bool any_pixel_ = false;
  double setting_ = 0.0;
  // Threshold = offset_ + max(setting x unit_, min_excess_).
  double offset_ = 0.0;
  double unit_ = 1.0;
  double min_excess_ = 0.0;
  std::optional<double> chosen_;  // threshold at setting(), if the image determines it
};

}  // namespace sonarcal::metrics
