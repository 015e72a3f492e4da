// Azimuth responses of all beams as a filter of rows of columns.
#pragma once

#include <vector>

#include "core/types/image.h"
#include "sim/physics/beam_and_pulse.h"

namespace sonarcal::sim {

// T: float or double, the precision of the sums. Single precision suffices for powers, because no term of
// their sums is negative.
template <typename T>
class AzimuthFilter {
 public:
  // One window per beam (AzimuthWindows).
  explicit AzimuthFilter(const std::vector<ResponseWindow>& windows);

  // Filters range bins x columns to range bins x beams, on all cores.
  Grid<T> Filter(const Grid<T>& in_bins) const;

 private:
  // Weights of two neighbouring beams for the same columns: the beams share the loads of the values.
  struct BeamPair {
    int first_col = 0;
    std::vector<T> weight[2];
  };

  int beams_;
  std::vector<BeamPair> pairs_;
};

}  // namespace sonarcal::sim
