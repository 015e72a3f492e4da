#include "core/math/local_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sonarcal {
namespace {

constexpr int kRows = 17;
constexpr int kCols = 11;

Grid<float> RandomImage() {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<float> any(100.0F, 200.0F);
  Grid<float> image(kRows, kCols);
  for (float& value : image.values()) value = any(random);
  return image;
}

// A cell in five does not count.
Mask SomeValid() {
  Mask valid(kRows, kCols, 1);
  for (std::size_t i = 0; i < valid.size(); i += 5) valid.values()[i] = 0;
  return valid;
}

bool Holds(const CellBlock& block, int row, int col) {
  return row >= block.top && row < block.bottom && col >= block.left && col < block.right;
}

TEST(BoxSumsTest, AreTheSumsOverEachBlockCellByCell) {
  const Grid<float> image = RandomImage();
  const BoxSums sums(kRows, kCols, image);
  for (const CellBlock& block : {CellBlock{0, kRows, 0, kCols}, CellBlock{3, 4, 5, 6}, CellBlock{2, 9, 0, 7},
                                 CellBlock{16, 17, 10, 11}, CellBlock{5, 5, 2, 8}}) {
    double sum = 0.0;
    for (int row = block.top; row < block.bottom; ++row) {
      for (int col = block.left; col < block.right; ++col) sum += image(row, col);
    }
    EXPECT_NEAR(sums.Over(block), sum, 1e-9);
  }
}

TEST(LocalSumsTest, AreTheMomentsOfTheTrainingCellsGatheredOneByOne) {
  const Grid<float> image = RandomImage();
  const Mask valid = SomeValid();
  const LocalSums sums(image, &valid);
  for (int row = 0; row < kRows; ++row) {
    for (int col = 0; col < kCols; ++col) {
      const TrainingWindow window = WindowAt({1, 1, 2, 1}, row, col, kRows, kCols);
      std::vector<double> cells;
      for (int r = 0; r < kRows; ++r) {
        for (int c = 0; c < kCols; ++c) {
          if (valid(r, c) != 0 && Holds(window.outer, r, c) && !Holds(window.guard, r, c))
            cells.push_back(image(r, c));
        }
      }
      double mean = 0.0;
      for (const double cell : cells) mean += cell / static_cast<double>(cells.size());
      double variance = 0.0;
      for (const double cell : cells)
        variance += (cell - mean) * (cell - mean) / static_cast<double>(cells.size());
      ASSERT_EQ(sums.Count(window), static_cast<int>(cells.size()));
      EXPECT_NEAR(sums.Over(window).mean, mean, 1e-9);
      EXPECT_NEAR(sums.Over(window).spread, std::sqrt(variance), 1e-9);
    }
  }
}

TEST(BoxMeanTest, IsTheMeanOfThePixelsThatLieWithinAndCount) {
  const Grid<float> image = RandomImage();
  const Mask valid = SomeValid();
  Grid<double> same(kRows, kCols);
  for (std::size_t i = 0; i < same.size(); ++i) same.values()[i] = image.values()[i];
  const Grid<float> of_valid = BoxMean(image, 5, 3, &valid);
  const Grid<double> of_all = BoxMean(same, 5, 3);
  for (int row = 0; row < kRows; ++row) {
    for (int col = 0; col < kCols; ++col) {
      double sum = 0.0;
      double count = 0.0;
      double valid_sum = 0.0;
      double valid_count = 0.0;
      for (int r = std::max(0, row - 2); r <= std::min(kRows - 1, row + 2); ++r) {
        for (int c = std::max(0, col - 1); c <= std::min(kCols - 1, col + 1); ++c) {
          sum += image(r, c);
          count += 1.0;
          if (valid(r, c) == 0) continue;
          valid_sum += image(r, c);
          valid_count += 1.0;
        }
      }
      EXPECT_NEAR(of_all(row, col), sum / count, 1e-9);
      EXPECT_NEAR(of_valid(row, col), valid_sum / valid_count, 1e-4);
    }
  }
}

TEST(BoxMeanTest, AnEvenBoxIsRefused) {
  EXPECT_THROW(BoxMean(Grid<float>(3, 3), 2, 3), std::logic_error);
  EXPECT_THROW(BoxMean(Grid<double>(3, 3), 3, 4), std::logic_error);
}

}  // namespace
}  // namespace sonarcal
