#include "metrics/bootstrap.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/math/statistics.h"
#include "core/types/error.h"

namespace sonarcal::metrics {

std::span<const int> FrameResampler::Next() {
  const std::size_t count = indices_.size();
  for (std::size_t i = 0; i < count;) {
    // std::uniform_int_distribution is not used because its results differ between standard libraries. The
    // bias of the modulo is below frame_count / 2^64.
    std::size_t frame = random_() % count;
    for (int k = 0; k < block_frames_ && i < count; ++k, ++i) {
      indices_[i] = static_cast<int>(frame);
      frame = frame + 1 == count ? 0 : frame + 1;
    }
  }
  return indices_;
}

int PolitisWhiteBlockLength(std::span<const double> series) {
  const int count = static_cast<int>(series.size());
  if (count < kBootstrapMinFrames) return 1;
  const double n = count;
  const int quiet_lags = std::max(5, static_cast<int>(std::ceil(std::sqrt(std::log10(n)))));
  const int max_lags = std::min(count - 1, static_cast<int>(std::ceil(std::sqrt(n))) + quiet_lags);
  const double longest = std::ceil(std::min(3.0 * std::sqrt(n), n / 3.0));

  const double mean = std::accumulate(series.begin(), series.end(), 0.0) / n;
  const auto autocovariance = [&](int lag) {
    double sum = 0.0;
    for (int i = 0; i + lag < count; ++i) sum += (series[i] - mean) * (series[i + lag] - mean);
    return sum / n;
  };
  std::vector<double> covariance;
  for (int lag = 0; lag <= max_lags; ++lag) covariance.push_back(autocovariance(lag));
  if (!(covariance[0] > 1e-24 * mean * mean)) return 1;  // all values are equal

  // Last significant lag: it is followed by `quiet_lags` insignificant correlations, or by the end.
  const double lost = 2.0 * std::sqrt(std::log10(n) / n) * covariance[0];
  int last_lag = 0;
  for (int lag = 1; lag <= max_lags && lag <= last_lag + quiet_lags; ++lag) {
    if (std::abs(covariance[lag]) > lost) last_lag = lag;
  }
  const int window = std::min(2 * last_lag, max_lags);
  double spectrum = covariance[0];  // spectrum at frequency 0
  double slope = 0.0;
  for (int lag = 1; lag <= window; ++lag) {
    const double share = static_cast<double>(lag) / window;
    const double weight = share <= 0.5 ? 1.0 : 2.0 * (1.0 - share);  // flat-top window
    spectrum += 2.0 * weight * covariance[lag];
    slope += 2.0 * weight * lag * covariance[lag];
  }
  if (spectrum == 0.0) return 1;
  const double length = std::cbrt(1.5 * slope * slope / (spectrum * spectrum) * n);
  return static_cast<int>(std::clamp(std::ceil(length), 1.0, longest));
}

Interval PercentileInterval95(std::vector<double> draws) {
  std::sort(draws.begin(), draws.end());
  return {QuantileOfSorted(draws, 0.025), QuantileOfSorted(draws, 0.975)};
}

}  // namespace sonarcal::metrics
