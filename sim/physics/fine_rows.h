// Rows of range finer than a bin, in which echoes are kept before the pulse smooths them.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "core/types/image.h"

namespace sonarcal::sim {

struct FineRows {
  // `steps` rows per range bin, for a pulse of this half-power length.
  FineRows(const PolarAxes& axes, int steps, double pulse_length_m)
      : count(axes.range_bins * steps),
        per_m(steps / axes.range_bin_m()),
        first_m(axes.range_min_m + 0.5 / per_m),
        part_m(0.75 * pulse_length_m) {
    SONARCAL_CHECK(pulse_length_m > 0.0, "a pulse of {} m, expected one above 0", pulse_length_m);
  }

  // Shares an echo between the two rows whose middles are nearest, so that an image changes smoothly with
  // range: calls take(row, part of the power) for those that exist.
  template <typename Take>
  void Share(double range_m, double power, const Take& take) const {
    const double position = (range_m - first_m) * per_m;
    if (!(position > -1.0)) return;
    const int row = static_cast<int>(position + 1.0) - 1;
    const double fraction = position - row;
    if (row >= 0 && row < count) take(row, (1.0 - fraction) * power);
    if (row + 1 < count) take(row + 1, fraction * power);
  }

  // As Share, for an echo from a patch that covers `depth_m` of range: parts at even steps over it, which the
  // pulse joins. A sloping surface then gives an even level, however far apart in range its rays are. A part
  // that would lie outside of the rows is reflected at their end, because patches beyond are not traced.
  template <typename Take>
  void Spread(double range_m, double depth_m, double power, const Take& take) const {
    depth_m = std::min(depth_m, kMaxParts * part_m);
    const int parts = std::max(1, static_cast<int>(std::ceil(depth_m / part_m)));
    const double near_m = first_m - 0.5 / per_m;
    const double far_m = near_m + count / per_m;
    for (int i = 0; i < parts; ++i) {
      double at_m = range_m + depth_m * ((i + 0.5) / parts - 0.5);
      if (parts > 1 && at_m < near_m) at_m = 2.0 * near_m - at_m;
      if (parts > 1 && at_m > far_m) at_m = 2.0 * far_m - at_m;
      Share(at_m, power / parts, take);
    }
  }

  static constexpr int kMaxParts = 64;

  int count;
  double per_m;
  double first_m;  // middle of row 0
  double part_m;   // largest step between parts: they leave a ripple of 0.4 % behind a Gaussian pulse
};

}  // namespace sonarcal::sim
