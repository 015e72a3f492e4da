#include "metrics/segmentation/local_contrast.h"

#include <opencv2/imgproc.hpp>

namespace sonarcal::metrics {
namespace {

// Sums over rectangles around each pixel, with zeros beyond the border.
cv::Mat1d BoxSums(const cv::Mat1d& image, int reach_rows, int reach_cols) {
  cv::Mat1d sums;
  cv::boxFilter(image, sums, CV_64F, cv::Size(2 * reach_cols + 1, 2 * reach_rows + 1), cv::Point(-1, -1),
                false, cv::BORDER_CONSTANT);
  return sums;
}

cv::Mat1d RingSums(const cv::Mat1d& image, const TrainingShape& ring) {
  cv::Mat1d sums = BoxSums(image, ring.guard_rows + ring.training_rows, ring.guard_cols + ring.training_cols);
  sums -= BoxSums(image, ring.guard_rows, ring.guard_cols);
  return sums;
}

}  // namespace

Grid<float> LocalContrast(const Grid<float>& value, const TrainingShape& ring, const Mask* valid) {
  Grid<float> contrast(value.rows(), value.cols());
  if (value.empty()) return contrast;
  cv::Mat1d weighted(value.rows(), value.cols(), 0.0);
  cv::Mat1d weight(value.rows(), value.cols(), 0.0);
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (valid != nullptr && valid->values()[i] == 0) continue;
    weight(static_cast<int>(i / value.cols()), static_cast<int>(i % value.cols())) = 1.0;
    weighted(static_cast<int>(i / value.cols()), static_cast<int>(i % value.cols())) = value.values()[i];
  }
  const cv::Mat1d sums = RingSums(weighted, ring);
  const cv::Mat1d counts = RingSums(weight, ring);
  for (int row = 0; row < value.rows(); ++row) {
    for (int col = 0; col < value.cols(); ++col) {
      if (counts(row, col) < 0.5 || weight(row, col) == 0.0) continue;
      contrast(row, col) = static_cast<float>(value(row, col) - sums(row, col) / counts(row, col));
    }
  }
  return contrast;
}

}  // namespace sonarcal::metrics
