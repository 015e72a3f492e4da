#include "metrics/measures/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/math/statistics.h"

namespace sonarcal::metrics {
namespace {

struct Point {
  double range_m = 0.0;
  double x_m = 0.0;
  double y_m = 0.0;
};

// Outline points in ascending order of range, like the rows.
std::vector<Point> OutlineOf(const Mask& region, const PolarAxes& axes) {
  const auto is_set = [&](int row, int col) {
    return row >= 0 && row < region.rows() && col >= 0 && col < region.cols() && region(row, col) != 0;
  };
  std::vector<Point> points;
  for (int row = 0; row < region.rows(); ++row) {
    for (int col = 0; col < region.cols(); ++col) {
      if (!is_set(row, col)) continue;
      if (is_set(row - 1, col) && is_set(row + 1, col) && is_set(row, col - 1) && is_set(row, col + 1))
        continue;
      const double range_m = axes.range_centre_m(row);
      const double azimuth_rad = axes.beam_azimuth_rad[col];
      points.push_back({range_m, range_m * std::sin(azimuth_rad), range_m * std::cos(azimuth_rad)});
    }
  }
  return points;
}

// Distance to the nearest of `others`, which are not empty and sorted by range. A point is never nearer than
// its difference in range, so the search starts at the same range and moves outwards until that difference
// exceeds the best distance.
double DistanceToNearest(const Point& point, const std::vector<Point>& others) {
  const auto by_range = [](const Point& other, double range_m) { return other.range_m < range_m; };
  const auto middle = std::lower_bound(others.begin(), others.end(), point.range_m, by_range);
  double nearest_m = std::numeric_limits<double>::infinity();
  const auto is_farther = [&](const Point& other) {
    if (std::abs(other.range_m - point.range_m) > nearest_m) return true;
    nearest_m = std::min(nearest_m, std::hypot(other.x_m - point.x_m, other.y_m - point.y_m));
    return false;
  };
  auto up = middle;
  auto down = middle;
  bool more_up = true, more_down = true;
  while (more_up || more_down) {
    more_up = more_up && up != others.end() && !is_farther(*up);
    if (more_up) ++up;
    more_down = more_down && down != others.begin() && !is_farther(*std::prev(down));
    if (more_down) --down;
  }
  return nearest_m;
}

}  // namespace

std::optional<double> OutlineDistance::mean_m() const {
  if (points == 0) return std::nullopt;
  return sum_m / static_cast<double>(points);
}

std::optional<double> OutlineDistance::hausdorff_95_m() const {
  if (frames != 1) return std::nullopt;
  return percentile_m;
}

OutlineDistance& OutlineDistance::operator+=(const OutlineDistance& other) {
  if (other.frames > 0) percentile_m = other.percentile_m;  // used only if there is exactly one frame
  frames += other.frames;
  points += other.points;
  sum_m += other.sum_m;
  return *this;
}

OutlineDistance MeasureOutlines(const Mask& real, const Mask& simulated, const PolarAxes& axes) {
  for (const Mask* mask : {&real, &simulated}) {
    SONARCAL_CHECK(mask->rows() == axes.range_bins && mask->cols() == axes.beam_count(),
                   "mask {} x {}, axes {} x {}", mask->rows(), mask->cols(), axes.range_bins,
                   axes.beam_count());
  }
  const std::vector<Point> of_real = OutlineOf(real, axes);
  const std::vector<Point> of_simulated = OutlineOf(simulated, axes);
  OutlineDistance result;
  if (of_real.empty() || of_simulated.empty()) return result;
  result.frames = 1;
  for (const auto& [points, others] :
       {std::pair{&of_real, &of_simulated}, std::pair{&of_simulated, &of_real}}) {
    std::vector<double> distances_m;
    for (const Point& point : *points) {
      distances_m.push_back(DistanceToNearest(point, *others));
      result.sum_m += distances_m.back();
    }
    result.points += static_cast<std::int64_t>(points->size());
    result.percentile_m = std::max(result.percentile_m, UpperQuantile(std::move(distances_m), 0.95));
  }
  return result;
}

}  // namespace sonarcal::metrics
