#include "metrics/segmentation/local_contrast.h"

#include "core/math/local_sums.h"

namespace sonarcal::metrics {

Grid<float> LocalContrast(const Grid<float>& value, const TrainingShape& ring, const Mask* valid) {
  const LocalSums sums(value, valid);
  Grid<float> contrast(value.rows(), value.cols());
  for (int row = 0; row < value.rows(); ++row) {
    for (int col = 0; col < value.cols(); ++col) {
      if (valid != nullptr && (*valid)(row, col) == 0) continue;
      const auto block = [&](int reach_rows, int reach_cols) {
        return BlockAbout(row, col, reach_rows, reach_cols, value.rows(), value.cols());
      };
      const TrainingWindow window = {
          block(ring.guard_rows + ring.training_rows, ring.guard_cols + ring.training_cols),
          block(ring.guard_rows, ring.guard_cols)};
      if (sums.Count(window) == 0) continue;
      contrast(row, col) = static_cast<float>(value(row, col) - sums.Over(window).mean);
    }
  }
  return contrast;
}

}  // namespace sonarcal::metrics
