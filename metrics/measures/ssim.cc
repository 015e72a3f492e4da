#include "metrics/measures/ssim.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace sonarcal::metrics {
namespace {

constexpr int kHalf = kSsimWindowPx / 2;

cv::Mat1d AsMatrix(const Grid<float>& grid) {
  cv::Mat1d matrix(grid.rows(), grid.cols());
  auto out = matrix.begin();
  for (const float value : grid.values()) *out++ = static_cast<double>(value);
  return matrix;
}

cv::Mat1d Product(const cv::Mat1d& a, const cv::Mat1d& b) {
  cv::Mat1d product;
  cv::multiply(a, b, product);
  return product;
}

cv::Mat1d WindowMean(const cv::Mat1d& image) {
  cv::Mat1d mean;
  cv::GaussianBlur(image, mean, cv::Size(kSsimWindowPx, kSsimWindowPx), kSsimSigmaPx, kSsimSigmaPx);
  return mean;
}

// Centres of the windows that lie completely inside.
cv::Mat1b WholeWindows(const Grid<float>& image, const Mask* inside) {
  cv::Mat1b whole(image.rows(), image.cols(), std::uint8_t{1});
  if (inside != nullptr) {
    auto out = whole.begin();
    for (const std::uint8_t set : inside->values()) *out++ = set;
  }
  const cv::Mat1b window(kSsimWindowPx, kSsimWindowPx, std::uint8_t{1});
  cv::erode(whole, whole, window, cv::Point(-1, -1), 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  return whole;
}

}  // namespace

std::optional<double> SsimSum::mean() const {
  if (windows == 0) return std::nullopt;
  return sum / static_cast<double>(windows);
}

SsimSum& SsimSum::operator+=(const SsimSum& other) {
  windows += other.windows;
  sum += other.sum;
  return *this;
}

StructuralSimilarity& StructuralSimilarity::operator+=(const StructuralSimilarity& other) {
  whole += other.whole;
  union_region += other.union_region;
  return *this;
}

StructuralSimilarity MeasureSsim(const Grid<float>& real, const Grid<float>& simulated, double full_scale,
                                 const Mask& real_object, const Mask& simulated_object, const Mask* inside) {
  StructuralSimilarity similarity;
  if (real.rows() < kSsimWindowPx || real.cols() < kSsimWindowPx) return similarity;
  const double c1 = 0.01 * full_scale * 0.01 * full_scale;
  const double c2 = 0.03 * full_scale * 0.03 * full_scale;
  const cv::Mat1d x = AsMatrix(real);
  const cv::Mat1d y = AsMatrix(simulated);
  const cv::Mat1d mean_x = WindowMean(x);
  const cv::Mat1d mean_y = WindowMean(y);
  const cv::Mat1d mean_xx = WindowMean(Product(x, x));
  const cv::Mat1d mean_yy = WindowMean(Product(y, y));
  const cv::Mat1d mean_xy = WindowMean(Product(x, y));
  const cv::Mat1b whole = WholeWindows(real, inside);
  for (int row = kHalf; row < real.rows() - kHalf; ++row) {
    for (int col = kHalf; col < real.cols() - kHalf; ++col) {
      if (whole(row, col) == 0) continue;
      const double mx = mean_x(row, col);
      const double my = mean_y(row, col);
      const double variance_x = mean_xx(row, col) - mx * mx;
      const double variance_y = mean_yy(row, col) - my * my;
      const double covariance = mean_xy(row, col) - mx * my;
      const double ssim = (2.0 * mx * my + c1) * (2.0 * covariance + c2) /
                          ((mx * mx + my * my + c1) * (variance_x + variance_y + c2));
      ++similarity.whole.windows;
      similarity.whole.sum += ssim;
      if (real_object(row, col) != 0 || simulated_object(row, col) != 0) {
        ++similarity.union_region.windows;
        similarity.union_region.sum += ssim;
      }
    }
  }
  return similarity;
}

}  // namespace sonarcal::metrics
