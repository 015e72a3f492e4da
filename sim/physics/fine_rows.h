// Rows of range finer than a bin, in which echoes are kept before the pulse smooths them.
#pragma once

#include "core/types/image.h"

namespace sonarcal::sim {

struct FineRows {
  // `steps` rows per range bin.
  FineRows(const PolarAxes& axes, int steps)
      : count(axes.range_bins * steps),
        per_m(steps / axes.range_bin_m()),
        first_m(axes.range_min_m + 0.5 / per_m) {}

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

  int count;
  double per_m;
  double first_m;  // middle of row 0
};

}  // namespace sonarcal::sim
