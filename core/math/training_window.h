// Training cells around a tested cell, from which its background is estimated: a rectangle without a smaller
// one, the guard, around the tested cell. Near the image's border the rectangle is shifted inwards as a
// whole, so the number of training cells stays (almost) constant. If the image is smaller than the rectangle,
// the rectangle is the whole image. The guard is cut at the border.
#pragma once

#include <algorithm>

namespace sonarcal {

// Rows top..bottom - 1, columns left..right - 1.
struct CellBlock {
  int top = 0;
  int bottom = 0;
  int left = 0;
  int right = 0;

  int count() const { return (bottom - top) * (right - left); }
  bool operator==(const CellBlock&) const = default;
};

// Cells at most `reach_rows` and `reach_cols` away from (row, col), cut at the border of rows x cols.
inline CellBlock BlockAbout(int row, int col, int reach_rows, int reach_cols, int rows, int cols) {
  return {std::max(0, row - reach_rows), std::min(rows, row + reach_rows + 1), std::max(0, col - reach_cols),
          std::min(cols, col + reach_cols + 1)};
}

struct TrainingWindow {
  CellBlock outer;
  CellBlock guard;  // inside `outer`

  int count() const { return outer.count() - guard.count(); }
};

struct TrainingShape {
  int guard_rows = 0;  // on each side of the tested cell, as for the other members
  int guard_cols = 0;
  int training_rows = 0;  // beyond the guard
  int training_cols = 0;
};

// Window of the tested cell (row, col) of an image of rows x cols.
inline TrainingWindow WindowAt(const TrainingShape& shape, int row, int col, int rows, int cols) {
  const auto shifted = [](int at, int reach, int size, int& begin, int& end) {
    const int length = std::min(2 * reach + 1, size);
    begin = std::clamp(at - reach, 0, size - length);
    end = begin + length;
  };
  TrainingWindow window;
  shifted(row, shape.guard_rows + shape.training_rows, rows, window.outer.top, window.outer.bottom);
  shifted(col, shape.guard_cols + shape.training_cols, cols, window.outer.left, window.outer.right);
  window.guard = BlockAbout(row, col, shape.guard_rows, shape.guard_cols, rows, cols);
  return window;
}

}  // namespace sonarcal
