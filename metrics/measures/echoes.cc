#include "metrics/measures/echoes.h"

#include <limits>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "metrics/segmentation/threshold.h"

namespace sonarcal::metrics {
namespace {

std::optional<double> Ratio(std::int64_t part, std::int64_t of) {
  if (of == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(of);
}

cv::Mat1b EchoesAbove(const Grid<float>& image, double level, const Mask* inside) {
  cv::Mat1b echoes(image.rows(), image.cols());
  auto out = echoes.begin();
  for (std::size_t i = 0; i < image.size(); ++i) {
    const bool counts = inside == nullptr || inside->values()[i] != 0;
    *out++ = counts && static_cast<double>(image.values()[i]) > level ? 1 : 0;
  }
  return echoes;
}

// Pixels within the tolerance of an echo.
cv::Mat1b Near(const cv::Mat1b& echoes) {
  constexpr int kSize = 2 * kEchoTolerancePx + 1;
  cv::Mat1b disk(kSize, kSize);
  for (int row = 0; row < kSize; ++row) {
    for (int col = 0; col < kSize; ++col) {
      const int down = row - kEchoTolerancePx;
      const int across = col - kEchoTolerancePx;
      disk(row, col) = down * down + across * across <= kEchoTolerancePx * kEchoTolerancePx ? 1 : 0;
    }
  }
  cv::Mat1b near;
  cv::dilate(echoes, near, disk, cv::Point(-1, -1), 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  return near;
}

std::int64_t CountBoth(const cv::Mat1b& a, const cv::Mat1b& b) {
  return cv::countNonZero(a & b);
}

}  // namespace

std::optional<double> EchoCounts::coverage_ratio() const {
  return Ratio(simulated, real);
}

std::optional<double> EchoCounts::matched_real() const {
  return Ratio(real_near_simulated, real);
}

std::optional<double> EchoCounts::matched_simulated() const {
  return Ratio(simulated_near_real, simulated);
}

EchoCounts& EchoCounts::operator+=(const EchoCounts& other) {
  real += other.real;
  simulated += other.simulated;
  real_near_simulated += other.real_near_simulated;
  simulated_near_real += other.simulated_near_real;
  return *this;
}

double EchoLevel(const Grid<float>& real, const Mask* inside) {
  std::vector<float> values;
  values.reserve(real.size());
  for (std::size_t i = 0; i < real.size(); ++i) {
    if (inside == nullptr || inside->values()[i] != 0) values.push_back(real.values()[i]);
  }
  return values.empty() ? std::numeric_limits<double>::infinity() : OtsuThreshold(values);
}

EchoCounts CountEchoes(const Grid<float>& real, const Grid<float>& simulated, double echo_level,
                       const Mask* inside) {
  const cv::Mat1b in_real = EchoesAbove(real, echo_level, inside);
  const cv::Mat1b in_simulated = EchoesAbove(simulated, echo_level, inside);
  return {.real = cv::countNonZero(in_real),
          .simulated = cv::countNonZero(in_simulated),
          .real_near_simulated = CountBoth(in_real, Near(in_simulated)),
          .simulated_near_real = CountBoth(in_simulated, Near(in_real))};
}

}  // namespace sonarcal::metrics
