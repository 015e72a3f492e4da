// Moments and ordered values of the training cells of a window (core/math/training_window.h) that moves over
// an image, at a cost that does not grow with the window (moments) or with its height alone (ordered values).
// Cells outside `valid` (the image's shape; null: all count) are no training cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math/training_window.h"
#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal {

struct Moments {
  double mean = 0.0;
  double spread = 0.0;  // standard deviation
};

// Mean and standard deviation of the training cells.
class LocalSums {
 public:
  explicit LocalSums(const Grid<float>& value, const Mask* valid = nullptr);

  // How many training cells count.
  int Count(const TrainingWindow& window) const;

  // Of one training cell at least.
  Moments Over(const TrainingWindow& window) const;

 private:
  double Over(const std::vector<double>& integral, const TrainingWindow& window) const;

  int stride_;
  double offset_;  // taken off every value, so that squares keep their digits
  std::vector<double> sum_;
  std::vector<double> square_;
  std::vector<double> count_;
};

// The k-th smallest training cell. Values are told apart to within a 4095th of the image's span.
class LocalOrder {
 public:
  explicit LocalOrder(const Grid<float>& value, const Mask* valid = nullptr);

  // Fast where the window moved to the right, by few columns, since the last call.
  void MoveTo(const TrainingWindow& window);

  // rank 1: the smallest; at most as many as training cells count.
  double RankthSmallest(int rank) const;

 private:
  static constexpr int kGroups = 64;
  static constexpr int kGroupSize = 64;
  static constexpr std::uint16_t kNoLevel = kGroups * kGroupSize;

  void Count(const CellBlock& block, int times);
  void Shift(const CellBlock& from, const CellBlock& to, int times);

  double low_;
  double step_;
  Grid<std::uint16_t> level_;  // kNoLevel where a cell does not count
  TrainingWindow window_;
  std::array<int, kGroups * kGroupSize> count_{};
  std::array<int, kGroups> group_count_{};
};

// The mean over rows x cols pixels about each pixel, both odd, of those that there are and count. The pixel
// itself where none does.
Grid<float> BoxMean(const Grid<float>& value, int rows, int cols, const Mask* valid = nullptr);

}  // namespace sonarcal
