#include "metrics/bootstrap.h"

#include <algorithm>
#include <cmath>

#include "data_io/types/error.h"

namespace sonarcal {
namespace {

double Quantile(const std::vector<double>& sorted, double share) {
  const double position = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], position - static_cast<double>(below));
}

}  // namespace

std::span<const int> FrameResampler::Next() {
  // Not std::uniform_int_distribution, whose results differ between standard libraries. The modulo's bias is
  // below frame_count / 2^64.
  for (int& index : indices_) index = static_cast<int>(random_() % indices_.size());
  return indices_;
}

Interval PercentileInterval95(std::vector<double> draws) {
  SONARCAL_CHECK(!draws.empty(), "an interval of nothing");
  std::sort(draws.begin(), draws.end());
  return {Quantile(draws, 0.025), Quantile(draws, 0.975)};
}

}  // namespace sonarcal
