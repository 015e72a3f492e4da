#include "metrics/segmentation/tidy.h"

#include <algorithm>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace sonarcal::metrics {
namespace {

// OpenCV matrix that shares the mask's memory.
cv::Mat1b PixelsOf(Mask& mask) {
  return {mask.rows(), mask.cols(), mask.values().data()};
}

enum class Morphology { kOpen, kClose };

// Morphological operation with no object beyond the image. OpenCV's own border would let closing extend an
// object to the edge. The second step has the mirrored anchor: with one anchor for both, as in
// cv::morphologyEx, an object would move by a pixel if a side of the rectangle is even.
void Morph(Mask& mask, Morphology operation, int rows, int cols) {
  if (rows <= 1 && cols <= 1) return;
  const cv::Size size(std::max(1, cols), std::max(1, rows));
  cv::Mat1b pixels = PixelsOf(mask);
  cv::Mat1b padded;
  cv::copyMakeBorder(pixels, padded, size.height, size.height, size.width, size.width, cv::BORDER_CONSTANT,
                     0);
  const cv::Mat rectangle = cv::getStructuringElement(cv::MORPH_RECT, size);
  const cv::Point anchor(size.width / 2, size.height / 2);
  const cv::Point mirrored(size.width - 1 - anchor.x, size.height - 1 - anchor.y);
  if (operation == Morphology::kOpen) {
    cv::erode(padded, padded, rectangle, anchor);
    cv::dilate(padded, padded, rectangle, mirrored);
  } else {
    cv::dilate(padded, padded, rectangle, anchor);
    cv::erode(padded, padded, rectangle, mirrored);
  }
  padded(cv::Rect(size.width, size.height, mask.cols(), mask.rows())).copyTo(pixels);
}

void KeepWithin(Mask& mask, const Mask& bounds) {
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (bounds.values()[i] == 0) mask.values()[i] = 0;
  }
}

void KeepComponents(Mask& mask, const SegmentationOptions& options) {
  const bool any_size = options.min_area_px <= 1 && options.max_rows == 0 && options.max_cols == 0;
  if (any_size && !options.largest_component_only) return;
  cv::Mat1b pixels = PixelsOf(mask);
  cv::Mat1i labels;
  cv::Mat1i statistics;
  cv::Mat1d centroids;
  const int count = cv::connectedComponentsWithStats(pixels, labels, statistics, centroids, 8);
  const auto area = [&](int label) { return statistics(label, cv::CC_STAT_AREA); };
  const auto fits = [&](int label) {
    return area(label) >= options.min_area_px &&
           (options.max_rows == 0 || statistics(label, cv::CC_STAT_HEIGHT) <= options.max_rows) &&
           (options.max_cols == 0 || statistics(label, cv::CC_STAT_WIDTH) <= options.max_cols);
  };
  std::vector<bool> kept(count, false);  // label 0 is the background
  int largest = 0;
  for (int label = 1; label < count; ++label) {
    kept[label] = fits(label);
    if (kept[label] && (largest == 0 || area(label) > area(largest))) largest = label;
  }
  auto pixel = pixels.begin();
  for (const int label : labels) {
    const bool keep = kept[label] && (!options.largest_component_only || label == largest);
    *pixel++ = keep ? 1 : 0;
  }
}

void Fill(Mask& mask, RegionFill fill) {
  if (fill == RegionFill::kNone) return;
  cv::Mat1b pixels = PixelsOf(mask);
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(pixels.clone(), outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  for (std::vector<cv::Point>& outline : outlines) {
    if (fill == RegionFill::kHull) {
      std::vector<cv::Point> hull;
      cv::convexHull(outline, hull);
      outline = std::move(hull);
    }
  }
  // Each outline is drawn separately: OpenCV would leave out areas that two of them share.
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    cv::drawContours(pixels, outlines, static_cast<int>(i), cv::Scalar(1), cv::FILLED);
  }
}

}  // namespace

void Tidy(Mask& object, const Mask& may_be_object, const SegmentationOptions& options) {
  if (object.empty()) return;
  Morph(object, Morphology::kOpen, options.open_rows, options.open_cols);
  Morph(object, Morphology::kClose, options.close_rows, options.close_cols);
  // Closing may have added pixels that cannot be object.
  KeepWithin(object, may_be_object);
  KeepComponents(object, options);
  Fill(object, options.fill);
  KeepWithin(object, may_be_object);
}

}  // namespace sonarcal::metrics
