#include "core/math/local_sums.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sonarcal {

namespace {

double MeanOfValid(const Grid<float>& value, const Mask* valid) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (valid != nullptr && valid->values()[i] == 0) continue;
    sum += value.values()[i];
    count += 1.0;
  }
  return sum / std::max(1.0, count);
}

// Sums of f(value) over cells that count.
template <typename Function>
BoxSums SumsOf(const Grid<float>& value, const Mask* valid, const Function& f) {
  return {value.rows(), value.cols(), [&](int row, int col) {
            return valid == nullptr || (*valid)(row, col) != 0 ? f(value(row, col)) : 0.0;
          }};
}

}  // namespace

LocalSums::LocalSums(const Grid<float>& value, const Mask* valid)
    : offset_(MeanOfValid(value, valid)),
      sum_(SumsOf(value, valid, [this](double v) { return v - offset_; })),
      square_(SumsOf(value, valid, [this](double v) { return (v - offset_) * (v - offset_); })),
      count_(SumsOf(value, valid, [](double) { return 1.0; })) {}

int LocalSums::Count(const TrainingWindow& window) const {
  return static_cast<int>(std::lround(count_.Over(window)));
}

Moments LocalSums::Over(const TrainingWindow& window) const {
  const double count = count_.Over(window);
  SONARCAL_CHECK(count > 0.5, "moments of {} cells", count);
  const double mean = sum_.Over(window) / count;
  const double square = square_.Over(window) / count;
  return {offset_ + mean, std::sqrt(std::max(0.0, square - mean * mean))};
}

LocalOrder::LocalOrder(const Grid<float>& value, const Mask* valid) : level_(value.rows(), value.cols()) {
  if (value.empty()) return;
  const auto [lowest, highest] = std::minmax_element(value.values().begin(), value.values().end());
  low_ = *lowest;
  const int levels = kGroups * kGroupSize - 1;
  if (*highest > *lowest) step_ = (static_cast<double>(*highest) - *lowest) / levels;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (valid != nullptr && valid->values()[i] == 0) {
      level_.values()[i] = kNoLevel;
      continue;
    }
    level_.values()[i] = static_cast<std::uint16_t>(
        std::clamp(std::lround((value.values()[i] - low_) / step_), 0L, static_cast<long>(levels)));
  }
}

void LocalOrder::Count(const CellBlock& block, int times) {
  for (int row = block.top; row < block.bottom; ++row) {
    for (int col = block.left; col < block.right; ++col) {
      if (level_(row, col) == kNoLevel) continue;
      count_[level_(row, col)] += times;
      group_count_[level_(row, col) / kGroupSize] += times;
    }
  }
}

// Moves from one rectangle to another of the same rows, which reaches at least as far to the right at both
// ends.
void LocalOrder::Shift(const CellBlock& from, const CellBlock& to, int times) {
  Count({from.top, from.bottom, from.left, std::min(to.left, from.right)}, -times);
  Count({from.top, from.bottom, std::max(from.right, to.left), to.right}, times);
}

void LocalOrder::MoveTo(const TrainingWindow& window) {
  const auto follows = [](const CellBlock& from, const CellBlock& to) {
    return from.count() > 0 && from.top == to.top && from.bottom == to.bottom && from.left <= to.left &&
           from.right <= to.right;
  };
  if (follows(window_.outer, window.outer) && follows(window_.guard, window.guard)) {
    Shift(window_.outer, window.outer, 1);
    Shift(window_.guard, window.guard, -1);
  } else {
    count_.fill(0);
    group_count_.fill(0);
    Count(window.outer, 1);
    Count(window.guard, -1);
  }
  window_ = window;
}

double LocalOrder::RankthSmallest(int rank) const {
  const int count = std::accumulate(group_count_.begin(), group_count_.end(), 0);
  SONARCAL_CHECK(rank >= 1 && rank <= count, "rank {} of {} cells", rank, count);
  int group = 0;
  while (rank > group_count_[group]) rank -= group_count_[group++];
  int level = group * kGroupSize;
  while (rank > count_[level]) rank -= count_[level++];
  return low_ + level * step_;
}

Grid<float> BoxMean(const Grid<float>& value, int rows, int cols, const Mask* valid) {
  SONARCAL_CHECK(rows % 2 == 1 && cols % 2 == 1, "a box of {} x {}", rows, cols);
  if (rows == 1 && cols == 1) return value;
  const LocalSums sums(value, valid);
  Grid<float> mean(value.rows(), value.cols());
  for (int row = 0; row < value.rows(); ++row) {
    for (int col = 0; col < value.cols(); ++col) {
      const TrainingWindow box = {BlockAbout(row, col, rows / 2, cols / 2, value.rows(), value.cols()), {}};
      mean(row, col) = sums.Count(box) > 0 ? static_cast<float>(sums.Over(box).mean) : value(row, col);
    }
  }
  return mean;
}

Grid<double> BoxMean(const Grid<double>& value, int rows, int cols) {
  SONARCAL_CHECK(rows % 2 == 1 && cols % 2 == 1, "a box of {} x {}", rows, cols);
  const BoxSums sums(value.rows(), value.cols(), value);
  Grid<double> mean(value.rows(), value.cols());
  for (int row = 0; row < value.rows(); ++row) {
    for (int col = 0; col < value.cols(); ++col) {
      const CellBlock box = BlockAbout(row, col, rows / 2, cols / 2, value.rows(), value.cols());
      mean(row, col) = sums.Over(box) / box.count();
    }
  }
  return mean;
}

}  // namespace sonarcal
