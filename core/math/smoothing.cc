#include "core/math/smoothing.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sonarcal {
namespace {

// Gaussian smoothing along one axis, renormalised at the edges.
void SmoothAlong(Grid<float>& image, double sigma, bool along_rows) {
  if (!(sigma > 0.0)) return;
  const int reach = static_cast<int>(std::ceil(3.0 * sigma));
  std::vector<double> kernel(reach + 1);
  for (int i = 0; i <= reach; ++i) kernel[i] = std::exp(-0.5 * i * i / (sigma * sigma));
  const int length = along_rows ? image.rows() : image.cols();
  const Grid<float> in = image;
  for (int row = 0; row < image.rows(); ++row) {
    for (int col = 0; col < image.cols(); ++col) {
      const int at = along_rows ? row : col;
      double sum = 0.0;
      double weight = 0.0;
      for (int i = std::max(0, at - reach); i <= std::min(length - 1, at + reach); ++i) {
        const double w = kernel[std::abs(i - at)];
        sum += w * (along_rows ? in(i, col) : in(row, i));
        weight += w;
      }
      image(row, col) = static_cast<float>(sum / weight);
    }
  }
}

}  // namespace

void Smooth(Grid<float>& image, double sigma_bins, double sigma_beams) {
  SmoothAlong(image, sigma_bins, true);
  SmoothAlong(image, sigma_beams, false);
}

}  // namespace sonarcal
