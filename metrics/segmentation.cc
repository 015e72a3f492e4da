#include "metrics/segmentation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "metrics/threshold.h"

namespace sonarcal {
namespace {

// Smoothing a constant image leaves rounding errors; what differs by less than this share of full scale is
// equal.
constexpr double kEqual = 1e-5;

constexpr std::array<std::pair<SegmentationMethod, std::string_view>, 3> kMethodNames = {{
    {SegmentationMethod::kBackgroundSigma, "background_sigma"},
    {SegmentationMethod::kOtsu, "otsu"},
    {SegmentationMethod::kFixedThreshold, "fixed_threshold"},
}};

void Require(bool condition, std::string_view field, double value, std::string_view expected) {
  if (!condition) throw DataError("segmentation {} is {}, expected {}", field, value, expected);
}

// The image and the masks, with the shapes checked once.
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

// Invalid pixels count as 0 here.
cv::Mat1f CopyOfValidValues(const Pixels& pixels) {
  cv::Mat1f copy(pixels.value.rows(), pixels.value.cols());
  auto out = copy.begin();
  for (std::size_t i = 0; i < pixels.value.size(); ++i) {
    *out++ = pixels.IsValid(i) ? pixels.value.values()[i] : 0.0f;
  }
  return copy;
}

cv::Mat1f GaussianBlur(const cv::Mat1f& image, const SegmentationOptions& options) {
  // OpenCV takes a standard deviation of zero for "as the other one"; this one leaves a single tap.
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

  // Invalid pixels carry no weight: without this the border of a fan would darken its neighbours.
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

template <typename Keep>
std::vector<float> Collect(const cv::Mat1f& image, Keep keep) {
  std::vector<float> values;
  std::size_t i = 0;
  for (const float value : image) {
    if (keep(i++)) values.push_back(value);
  }
  return values;
}

// `searched`: the values of the pixels that may be object, not empty.
double Threshold(const cv::Mat1f& smoothed, const std::vector<float>& searched, double full_scale,
                 const Pixels& pixels, const SegmentationOptions& options) {
  switch (options.method) {
    case SegmentationMethod::kOtsu: {
      const auto [lowest, highest] = std::minmax_element(searched.begin(), searched.end());
      return *highest - *lowest <= kEqual * full_scale ? *highest : OtsuThreshold(searched);
    }
    case SegmentationMethod::kFixedThreshold:
      return options.threshold_fraction * full_scale;
    case SegmentationMethod::kBackgroundSigma:
      break;
  }
  Background background;
  if (options.background == BackgroundSample::kRobust) {
    background = RobustBackground(searched);
  } else {
    std::vector<float> outside =
        Collect(smoothed, [&](std::size_t i) { return pixels.IsValid(i) && !pixels.IsInRegion(i); });
    if (outside.empty()) {
      throw DataError(
          "segmentation background is outside_region, but no pixel lies outside the region of "
          "interest; expected a region smaller than the image");
    }
    background = PlainBackground(std::move(outside));
  }
  return background.centre +
         std::max(options.sigma_count * background.spread, options.min_contrast * full_scale);
}

// Beyond the image there is no object. OpenCV's own border would let closing grow an object to the edge.
void Morph(cv::Mat1b& mask, cv::MorphTypes operation, int rows, int cols) {
  if (rows <= 1 && cols <= 1) return;
  const cv::Size size(std::max(1, cols), std::max(1, rows));
  cv::Mat1b padded;
  cv::copyMakeBorder(mask, padded, size.height, size.height, size.width, size.width, cv::BORDER_CONSTANT, 0);
  cv::morphologyEx(padded, padded, operation, cv::getStructuringElement(cv::MORPH_RECT, size));
  padded(cv::Rect(size.width, size.height, mask.cols, mask.rows)).copyTo(mask);
}

void KeepComponents(cv::Mat1b& mask, int min_area_px, bool largest_only) {
  if (min_area_px <= 1 && !largest_only) return;
  cv::Mat1i labels;
  cv::Mat1i statistics;
  cv::Mat1d centroids;
  const int count = cv::connectedComponentsWithStats(mask, labels, statistics, centroids, 8);
  const auto area = [&](int label) { return statistics(label, cv::CC_STAT_AREA); };
  int largest = 0;  // label 0 is the background
  for (int label = 1; label < count; ++label) {
    if (largest == 0 || area(label) > area(largest)) largest = label;
  }
  auto pixel = mask.begin();
  for (const int label : labels) {
    const bool keep = label != 0 && area(label) >= min_area_px && (!largest_only || label == largest);
    *pixel++ = keep ? 1 : 0;
  }
}

}  // namespace

std::string_view ToString(SegmentationMethod method) {
  for (const auto& [known, name] : kMethodNames) {
    if (known == method) return name;
  }
  return "unknown method";
}

SegmentationMethod SegmentationMethodFromString(std::string_view name) {
  for (const auto& [method, known] : kMethodNames) {
    if (known == name) return method;
  }
  throw UsageError("segmentation method '{}', expected background_sigma, otsu or fixed_threshold", name);
}

std::string_view ToString(BackgroundSample sample) {
  return sample == BackgroundSample::kRobust ? "robust" : "outside_region";
}

void SegmentationOptions::Check() const {
  Require(std::isfinite(sigma_count) && sigma_count > 0.0, "sigma_count", sigma_count, "more than 0");
  Require(min_contrast >= 0.0 && min_contrast <= 1.0, "min_contrast", min_contrast, "0 to 1");
  Require(threshold_fraction >= 0.0 && threshold_fraction <= 1.0, "threshold_fraction", threshold_fraction,
          "0 to 1");
  Require(median_px == 0 || median_px == 3 || median_px == 5, "median_px", median_px, "0, 3 or 5");
  for (const auto& [field, value] : {std::pair{"blur_rows", blur_rows}, {"blur_cols", blur_cols}}) {
    Require(value >= 0.0 && value <= 100.0, field, value, "0 to 100");
  }
  for (const auto& [field, value] : {std::pair{"open_rows", open_rows},
                                     {"open_cols", open_cols},
                                     {"close_rows", close_rows},
                                     {"close_cols", close_cols}}) {
    Require(value >= 0 && value <= 1001, field, value, "0 to 1001");
  }
  Require(min_area_px >= 0, "min_area_px", min_area_px, "0 or more");
}

Segmentation Segment(const Grid<float>& value, double full_scale, const SegmentationOptions& options,
                     const Mask* region, const Mask* valid) {
  options.Check();
  const Pixels pixels{value, region, valid};
  CheckPixels(pixels);
  Segmentation result{Mask(value.rows(), value.cols()), full_scale};
  if (value.empty()) return result;

  const cv::Mat1f smoothed = Smooth(pixels, options);
  const std::vector<float> searched = Collect(smoothed, [&](std::size_t i) { return pixels.MayBeObject(i); });
  if (searched.empty()) return result;
  result.threshold = Threshold(smoothed, searched, full_scale, pixels, options);

  cv::Mat1b mask(value.rows(), value.cols(), result.object.values().data());  // shares the result's pixels
  std::size_t i = 0;
  for (const float v : smoothed) {
    result.object.values()[i] = pixels.MayBeObject(i) && v > result.threshold ? 1 : 0;
    ++i;
  }
  Morph(mask, cv::MORPH_OPEN, options.open_rows, options.open_cols);
  Morph(mask, cv::MORPH_CLOSE, options.close_rows, options.close_cols);
  // Closing may have bridged pixels that cannot be object.
  for (i = 0; i < value.size(); ++i) {
    if (!pixels.MayBeObject(i)) result.object.values()[i] = 0;
  }
  KeepComponents(mask, options.min_area_px, options.largest_component_only);
  return result;
}

Segmentation Segment(const PolarImage& image, const SegmentationOptions& options, const Mask* region) {
  return Segment(image.value, image.scale.full_scale, options, region);
}

Segmentation Segment(const FanImage& image, const SegmentationOptions& options, const Mask* region) {
  return Segment(image.value, image.scale.full_scale, options, region, &image.inside);
}

Mask BoxAround(const Mask& object, int margin_rows, int margin_cols) {
  SONARCAL_CHECK(margin_rows >= 0 && margin_cols >= 0, "margins {} and {}", margin_rows, margin_cols);
  int top = object.rows(), bottom = -1, left = object.cols(), right = -1;
  for (int row = 0; row < object.rows(); ++row) {
    for (int col = 0; col < object.cols(); ++col) {
      if (object(row, col) == 0) continue;
      top = std::min(top, row);
      bottom = std::max(bottom, row);
      left = std::min(left, col);
      right = std::max(right, col);
    }
  }
  Mask box(object.rows(), object.cols());
  if (bottom < 0) return box;
  for (int row = std::max(0, top - margin_rows); row <= std::min(object.rows() - 1, bottom + margin_rows);
       ++row) {
    for (int col = std::max(0, left - margin_cols); col <= std::min(object.cols() - 1, right + margin_cols);
         ++col) {
      box(row, col) = 1;
    }
  }
  return box;
}

}  // namespace sonarcal
