#include "metrics/segmentation/scored_image.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "metrics/segmentation/cfar.h"
#include "metrics/segmentation/likelihood_ratio.h"
#include "metrics/segmentation/local_contrast.h"
#include "metrics/segmentation/threshold.h"
#include "metrics/segmentation/tidy.h"

namespace sonarcal::metrics {
namespace {

// Tolerance for equal values, as a fraction of full scale: smoothing a constant image leaves rounding errors.
constexpr double kEqual = 1e-5;

// Image and masks, with their shapes checked once.
struct Pixels {
  const Grid<float>& value;
  const Mask* region;
  const Mask* valid;

  bool IsValid(std::size_t i) const { return valid == nullptr || valid->values()[i] != 0; }
  bool IsInRegion(std::size_t i) const { return region == nullptr || region->values()[i] != 0; }
  bool MayBeObject(std::size_t i) const { return IsValid(i) && IsInRegion(i); }
};

void CheckPixels(const Pixels& pixels) {
  const auto check_shape = [&](const Mask* mask, std::string_view name) {
    if (mask == nullptr) return;
    SONARCAL_CHECK(mask->rows() == pixels.value.rows() && mask->cols() == pixels.value.cols(),
                   "{} mask {} x {}, image {} x {}", name, mask->rows(), mask->cols(), pixels.value.rows(),
                   pixels.value.cols());
  };
  check_shape(pixels.region, "region");
  check_shape(pixels.valid, "valid");
  for (std::size_t i = 0; i < pixels.value.size(); ++i) {
    if (pixels.IsValid(i) && !std::isfinite(pixels.value.values()[i])) {
      throw DataError("pixel (row {}, column {}) is {}, expected a finite value", i / pixels.value.cols(),
                      i % pixels.value.cols(), pixels.value.values()[i]);
    }
  }
}

// Copy of the image with invalid pixels set to 0.
cv::Mat1f CopyOfValidValues(const Pixels& pixels) {
  cv::Mat1f copy(pixels.value.rows(), pixels.value.cols());
  auto out = copy.begin();
  for (std::size_t i = 0; i < pixels.value.size(); ++i) {
    *out++ = pixels.IsValid(i) ? pixels.value.values()[i] : 0.0f;
  }
  return copy;
}

cv::Mat1f GaussianBlur(const cv::Mat1f& image, const SegmentationOptions& options) {
  // OpenCV replaces a standard deviation of zero by the other one; this value gives a kernel of one element.
  constexpr double kNoBlur = 1e-3;
  cv::Mat1f blurred;
  cv::GaussianBlur(image, blurred, cv::Size(), options.blur_cols > 0.0 ? options.blur_cols : kNoBlur,
                   options.blur_rows > 0.0 ? options.blur_rows : kNoBlur);
  return blurred;
}

cv::Mat1f Smooth(const Pixels& pixels, const SegmentationOptions& options) {
  cv::Mat1f image = CopyOfValidValues(pixels);
  if (options.median_px > 0) cv::medianBlur(image, image, options.median_px);
  if (options.blur_rows == 0.0 && options.blur_cols == 0.0) return image;
  if (pixels.valid == nullptr) return GaussianBlur(image, options);

  // Invalid pixels have no weight; otherwise the border of a fan would darken its neighbours.
  cv::Mat1f weight(image.size());
  auto weight_out = weight.begin();
  auto image_out = image.begin();
  for (std::size_t i = 0; i < pixels.value.size(); ++i, ++weight_out, ++image_out) {
    *weight_out = pixels.IsValid(i) ? 1.0f : 0.0f;
    *image_out *= *weight_out;  // a median may have filled it
  }
  cv::Mat1f blurred;
  cv::divide(GaussianBlur(image, options), cv::max(GaussianBlur(weight, options), 1e-6), blurred);
  return blurred;
}

Grid<float> SmoothedGrid(const Pixels& pixels, const SegmentationOptions& options) {
  Grid<float> smoothed(pixels.value.rows(), pixels.value.cols());
  cv::Mat1f shared(smoothed.rows(), smoothed.cols(), smoothed.values().data());
  Smooth(pixels, options).copyTo(shared);
  return smoothed;
}

template <typename Keep>
std::vector<float> Collect(const Grid<float>& image, Keep keep) {
  std::vector<float> values;
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (keep(i)) values.push_back(image.values()[i]);
  }
  return values;
}

bool IsConstant(const std::vector<float>& values, double full_scale) {
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  return *highest - *lowest <= kEqual * full_scale;
}

// `searched`: values of the pixels that may be object, not empty.
Background BackgroundOf(const Grid<float>& smoothed, const std::vector<float>& searched, const Pixels& pixels,
                        BackgroundSample sample) {
  if (sample == BackgroundSample::kRobust) return RobustBackground(searched);
  std::vector<float> outside =
      Collect(smoothed, [&](std::size_t i) { return pixels.IsValid(i) && !pixels.IsInRegion(i); });
  if (outside.empty()) {
    throw DataError(
        "segmentation background is outside_region, but no pixel lies outside the region of "
        "interest; expected a region smaller than the image");
  }
  return PlainBackground(std::move(outside));
}

// dB between 0 and full scale, if the scale states them.
std::optional<double> SpanDb(const ImageScale& scale) {
  if (scale.db_min && scale.db_max) return *scale.db_max - *scale.db_min;
  return scale.db_span;
}

double ContrastFraction(const ImageScale& scale, const SegmentationOptions& options) {
  if (!options.contrast_db) return options.contrast;
  const std::optional<double> span_db = SpanDb(scale);
  if (!span_db) {
    throw DataError(
        "segmentation by a contrast of {:g} dB, but the image does not state its dB scale; expected a "
        "contrast in parts of full scale",
        *options.contrast_db);
  }
  return *options.contrast_db / *span_db;
}

Grid<float> Decades(const Grid<float>& value, const ImageScale& scale, const SegmentationOptions& options,
                    const Mask* valid) {
  if (options.method == SegmentationMethod::kLikelihoodRatio) {
    return LikelihoodDecades(value, scale.full_scale, *options.background_law, options.cell_rows,
                             options.cell_cols, valid);
  }
  const std::optional<double> span_db = SpanDb(scale);
  if (options.cfar_domain == CfarDomain::kGrey ||
      (options.cfar_domain == CfarDomain::kAuto && !span_db && !options.background_law)) {
    return CfarDecadesInGrey(value, scale.full_scale, options, valid);
  }
  if (!span_db && !options.background_law) {
    throw DataError("segmentation by {} in power, but the image does not state its dB scale; expected grey",
                    ToString(options.method));
  }
  return CfarDecadesInPower(PowerOfGrey(value, scale.full_scale,
                                        options.background_law ? options.background_law->power_of_value
                                                               : LogDisplayPower(*span_db)),
                            options, valid);
}

}  // namespace

std::string_view SettingUnit(SegmentationMethod method) {
  switch (method) {
    case SegmentationMethod::kBackgroundSigma:
      return "standard deviations";
    case SegmentationMethod::kCaCfar:
    case SegmentationMethod::kOsCfar:
    case SegmentationMethod::kLikelihoodRatio:
      return "-log10 of the false-alarm rate";
    case SegmentationMethod::kOtsu:
    case SegmentationMethod::kFixedThreshold:
    case SegmentationMethod::kTriangle:
    case SegmentationMethod::kLocalContrast:
      break;
  }
  return "part of full scale";
}

ScoredImage::ScoredImage(const Grid<float>& value, const ImageScale& scale,
                         const SegmentationOptions& options, const Mask* region, const Mask* valid)
    : options_(options), may_be_object_(value.rows(), value.cols()) {
  options.Check();
  const Pixels pixels{value, region, valid};
  CheckPixels(pixels);
  for (std::size_t i = 0; i < value.size(); ++i) {
    may_be_object_.values()[i] = pixels.MayBeObject(i) ? 1 : 0;
    any_pixel_ = any_pixel_ || pixels.MayBeObject(i);
  }
  const double full_scale = scale.full_scale;
  // Result if no pixel may be object, or if all values are equal.
  const auto find_none = [&](double threshold) {
    offset_ = threshold;
    unit_ = 0.0;
  };
  if (!any_pixel_) {
    find_none(full_scale);
    score_ = value;
    return;
  }

  if (StatesFalseAlarmRate(options.method)) {
    score_ = Decades(value, scale, options, valid);
    setting_ = -std::log10(options.false_alarm_rate);
    return;
  }

  score_ = SmoothedGrid(pixels, options);
  const std::vector<float> searched =
      Collect(score_, [&](std::size_t i) { return may_be_object_.values()[i] != 0; });
  unit_ = full_scale;
  switch (options.method) {
    case SegmentationMethod::kOtsu:
    case SegmentationMethod::kTriangle: {
      if (IsConstant(searched, full_scale)) {
        find_none(*std::max_element(searched.begin(), searched.end()));
        break;
      }
      const double threshold = options.method == SegmentationMethod::kOtsu
                                   ? OtsuThreshold(searched)
                                   : TriangleThreshold(searched, full_scale);
      // Does not use the setting: rounding must not move a threshold across a grey level.
      setting_ = threshold / full_scale;
      chosen_ = threshold;
      break;
    }
    case SegmentationMethod::kLocalContrast:
      score_ = LocalContrast(
          score_, {options.guard_rows, options.guard_cols, options.training_rows, options.training_cols},
          valid);
      setting_ = ContrastFraction(scale, options);
      // Rounding errors are not contrast.
      min_excess_ = kEqual * full_scale;
      break;
    case SegmentationMethod::kBackgroundSigma: {
      const Background background = BackgroundOf(score_, searched, pixels, options.background);
      offset_ = background.centre;
      unit_ = background.spread;
      min_excess_ = options.min_contrast * full_scale;
      setting_ = options.sigma_count;
      break;
    }
    default:
      setting_ = options.threshold_fraction;
  }
}

double ScoredImage::ThresholdAt(double setting) const {
  if (chosen_ && setting == setting_) return *chosen_;
  return offset_ + std::max(setting * unit_, min_excess_);
}

Mask ScoredImage::ObjectAbove(double threshold, const Mask* within) const {
  std::optional<Mask> narrower;
  if (within != nullptr) narrower = Both(may_be_object_, *within);
  const Mask& may_be_object = narrower ? *narrower : may_be_object_;
  Mask object(score_.rows(), score_.cols());
  for (std::size_t i = 0; i < score_.size(); ++i) {
    object.values()[i] = may_be_object.values()[i] != 0 && score_.values()[i] > threshold ? 1 : 0;
  }
  Tidy(object, may_be_object, options_);
  return object;
}

}  // namespace sonarcal::metrics
