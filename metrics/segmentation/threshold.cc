#include "metrics/segmentation/threshold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/math/statistics.h"
#include "core/types/error.h"

namespace sonarcal::metrics {
namespace {

constexpr int kClasses = 4096;

struct ValueClass {
  std::int64_t count = 0;
  double sum = 0.0;
  double highest = 0.0;
};

}  // namespace

double OtsuThreshold(const std::vector<float>& values) {
  SONARCAL_CHECK(!values.empty(), "the threshold of nothing");
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  const double low = *lowest;
  const double span = *highest - low;
  if (span == 0.0) return low;

  std::array<ValueClass, kClasses> classes;
  double total = 0.0;
  for (const double value : values) {
    ValueClass& its_class = classes[std::lround((value - low) / span * (kClasses - 1))];
    its_class.highest = its_class.count == 0 ? value : std::max(its_class.highest, value);
    its_class.count += 1;
    its_class.sum += value;
    total += value;
  }

  const auto count = static_cast<double>(values.size());
  double below_count = 0.0;
  double below_sum = 0.0;
  double best_variance = -1.0;
  double threshold = low;
  for (const ValueClass& next : classes) {
    if (next.count == 0) continue;
    below_count += static_cast<double>(next.count);
    below_sum += next.sum;
    const double above_count = count - below_count;
    if (above_count == 0.0) break;
    const double distance = (total - below_sum) / above_count - below_sum / below_count;
    const double variance = below_count * above_count * distance * distance;
    if (variance > best_variance) {
      best_variance = variance;
      threshold = next.highest;
    }
  }
  return threshold;
}

double TriangleThreshold(const std::vector<float>& values, double full_scale) {
  SONARCAL_CHECK(!values.empty() && full_scale > 0.0, "the threshold of {} values, full scale {}",
                 values.size(), full_scale);
  constexpr int kLast = 255;
  std::array<std::int64_t, kLast + 1> count{};
  for (const double value : values) {
    ++count[std::clamp(std::lround(value / full_scale * kLast), 0L, static_cast<long>(kLast))];
  }
  const auto is_used = [](std::int64_t n) { return n > 0; };
  const auto first = static_cast<int>(std::find_if(count.begin(), count.end(), is_used) - count.begin());
  const auto last =
      kLast - static_cast<int>(std::find_if(count.rbegin(), count.rend(), is_used) - count.rbegin());
  const auto top = static_cast<int>(std::max_element(count.begin(), count.end()) - count.begin());
  // A tail ends at the first empty class.
  const int low_end = std::max(0, first - 1);
  const int high_end = std::min(kLast, last + 1);
  const int step = top - low_end < high_end - top ? -1 : 1;  // from the end of the longer tail to the top
  const int end = step < 0 ? high_end : low_end;
  const auto height = static_cast<double>(count[top]);
  const double width = std::abs(top - end);
  int farthest = end;
  double most = 0.0;
  for (int i = end + step; i != top + step; i += step) {
    const double below = height * std::abs(i - end) - width * static_cast<double>(count[i]);
    if (below > most) {
      most = below;
      farthest = i;
    }
  }
  return (farthest - step) * full_scale / kLast;
}

Background RobustBackground(std::vector<float> values) {
  const double centre = Median(values);
  for (float& value : values) value = static_cast<float>(std::abs(value - centre));
  return {centre, kSigmaPerMad * Median(std::move(values))};
}

Background PlainBackground(std::vector<float> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  const double mean = sum / static_cast<double>(values.size());
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  const double spread = std::sqrt(squares / static_cast<double>(values.size()));
  return {Median(std::move(values)), spread};
}

}  // namespace sonarcal::metrics
