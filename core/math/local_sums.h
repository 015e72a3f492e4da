// Sums over rectangles of an image, and moments and ordered values of the training cells of a moving window
// (core/math/training_window.h). The cost does not depend on the size of the rectangle or window (sums,
// moments), or only on its height (ordered values). Cells outside `valid` (the image's shape; null: all are
// valid) are not training cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math/training_window.h"
#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal {

// Sums over rectangles of an image (a summed-area table).
class BoxSums {
 public:
  // value_of(row, col) gives the value of each cell, row by row.
  template <typename ValueOf>
  BoxSums(int rows, int cols, const ValueOf& value_of) : sum_(rows + 1, cols + 1) {
    for (int row = 0; row < rows; ++row) {
      double line = 0.0;
      for (int col = 0; col < cols; ++col) {
        line += value_of(row, col);
        sum_(row + 1, col + 1) = sum_(row, col + 1) + line;
      }
    }
  }

  double Over(const CellBlock& block) const {
    return sum_(block.bottom, block.right) - sum_(block.top, block.right) - sum_(block.bottom, block.left) +
           sum_(block.top, block.left);
  }
  double Over(const TrainingWindow& window) const { return Over(window.outer) - Over(window.guard); }

 private:
  Grid<double> sum_;  // sum of all cells above and to the left of a corner
};

struct Moments {
  double mean = 0.0;
  double spread = 0.0;  // standard deviation
};

// Mean and standard deviation of the training cells.
class LocalSums {
 public:
  explicit LocalSums(const Grid<float>& value, const Mask* valid = nullptr);

  // Number of valid training cells.
  int Count(const TrainingWindow& window) const;

  // Moments of at least one training cell.
  Moments Over(const TrainingWindow& window) const;

 private:
  double offset_;  // subtracted from every value to keep the digits of squares
  BoxSums sum_;
  BoxSums square_;
  BoxSums count_;
};

// The k-th smallest training cell. Values are resolved to a 4095th of the image's span.
class LocalOrder {
 public:
  explicit LocalOrder(const Grid<float>& value, const Mask* valid = nullptr);

  // Moves the window. Fast if it moves to the right by few columns.
  void MoveTo(const TrainingWindow& window);

  // Value of rank 1 (smallest) .. number of valid training cells.
  double RankthSmallest(int rank) const;

 private:
  static constexpr int kGroups = 64;
  static constexpr int kGroupSize = 64;
  static constexpr std::uint16_t kNoLevel = kGroups * kGroupSize;

  void Count(const CellBlock& block, int times);
  void Shift(const CellBlock& from, const CellBlock& to, int times);

  double low_ = 0.0;
  double step_ = 1.0;
  Grid<std::uint16_t> level_;  // kNoLevel for an invalid cell
  TrainingWindow window_;
  std::array<int, kGroups * kGroupSize> count_{};
  std::array<int, kGroups> group_count_{};
};

// Mean of the valid pixels in a box of rows x cols, both odd, around each pixel. Equals the pixel itself if
// none is valid.
Grid<float> BoxMean(const Grid<float>& value, int rows, int cols, const Mask* valid = nullptr);

// Box mean over all pixels of an image, in double precision, without the shift that keeps the digits of
// squares.
Grid<double> BoxMean(const Grid<double>& value, int rows, int cols);

}  // namespace sonarcal
