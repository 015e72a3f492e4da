// Order statistics: ranked values, medians, quantiles. No sample may be empty and no value may be NaN.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/types/error.h"

namespace sonarcal {

// Standard deviation of a normal law over its median absolute deviation: 1 / (quantile 0.75 of the standard
// normal law).
inline constexpr double kSigmaPerMad = 1.4826;

// The value at place `rank` of the sorted sample; 0 is the smallest. rank < values.size().
template <typename T>
T RankedValue(std::vector<T> values, std::size_t rank) {
  SONARCAL_CHECK(rank < values.size(), "rank {} of {} values", rank, values.size());
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The value at place floor(share (n - 1)) of the sorted sample: the quantile rounded down to a value of the
// sample. share: 0 (smallest) .. 1 (largest).
template <typename T>
T LowerQuantile(std::vector<T> values, double share) {
  SONARCAL_CHECK(!values.empty() && share >= 0.0 && share <= 1.0, "quantile {} of {} values", share,
                 values.size());
  const auto rank = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  return RankedValue(std::move(values), rank);
}

// The value at place ceil(share n) - 1 of the sorted sample: the smallest value that at least this share of
// the sample does not exceed (nearest rank). share: 0 (smallest) .. 1 (largest).
template <typename T>
T UpperQuantile(std::vector<T> values, double share) {
  SONARCAL_CHECK(!values.empty() && share >= 0.0 && share <= 1.0, "quantile {} of {} values", share,
                 values.size());
  const auto count = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return RankedValue(std::move(values), std::max<std::size_t>(count, 1) - 1);
}

// Quantile between the two nearest values of the sample, by a straight line over the place share (n - 1)
// (Hyndman & Fan, Am. Stat. 50(4), 1996, type 7). share: 0 (smallest) .. 1 (largest).
inline double QuantileOfSorted(const std::vector<double>& sorted, double share) {
  SONARCAL_CHECK(!sorted.empty() && share >= 0.0 && share <= 1.0, "quantile {} of {} values", share,
                 sorted.size());
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

inline double Quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return QuantileOfSorted(values, share);
}

// The middle value; the mean of the two middle ones if their number is even.
template <typename T>
double Median(std::vector<T> values) {
  SONARCAL_CHECK(!values.empty(), "the median of nothing");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (static_cast<double>(*middle) + *std::max_element(values.begin(), middle));
}

// The middle value; the larger of the two middle ones if their number is even. It is a value of the sample.
template <typename T>
T UpperMedian(std::vector<T> values) {
  const std::size_t middle = values.size() / 2;
  return RankedValue(std::move(values), middle);
}

}  // namespace sonarcal
