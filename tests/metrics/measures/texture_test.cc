#include "metrics/measures/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using testing::GridOf;
using testing::SpeckledBlock;

// Bilinear interpolation on the circle, as the paper writes it.
int SlowPattern(const Grid<float>& image, int row, int col) {
  int bits[8];
  for (int p = 0; p < 8; ++p) {
    const double angle = 2.0 * std::numbers::pi * p / 8.0;
    const double y = row - std::sin(angle), x = col + std::cos(angle);
    const double down = y - std::floor(y + 1e-9), across = x - std::floor(x + 1e-9);
    const int top = static_cast<int>(std::floor(y + 1e-9)), left = static_cast<int>(std::floor(x + 1e-9));
    const auto at = [&](int r, int c) {
      return image(std::min(r, image.rows() - 1), std::min(c, image.cols() - 1));
    };
    const double value = (1 - down) * (1 - across) * at(top, left) + (1 - down) * across * at(top, left + 1) +
                         down * (1 - across) * at(top + 1, left) + down * across * at(top + 1, left + 1);
    bits[p] = value >= image(row, col) - 1e-7 ? 1 : 0;
  }
  int changes = 0, set = 0;
  for (int p = 0; p < 8; ++p) {
    changes += std::abs(bits[p] - bits[(p + 7) % 8]);
    set += bits[p];
  }
  return changes <= 2 ? set : 9;
}

TEST(TextureTest, EveryPatternAgreesWithTheInterpolatedCircle) {
  const Grid<float> image = SpeckledBlock(3, 40.0).value;
  for (int row = 1; row + 1 < image.rows(); ++row) {
    for (int col = 1; col + 1 < image.cols(); ++col) {
      ASSERT_EQ(BinaryPattern(image, row, col), SlowPattern(image, row, col)) << row << " " << col;
    }
  }
}

TEST(TextureTest, PatternsOfSimpleNeighbourhoods) {
  EXPECT_EQ(BinaryPattern(Grid<float>(3, 3, 77.3F), 1, 1), 8) << "an even area: every neighbour is as high";
  EXPECT_EQ(BinaryPattern(GridOf({{0, 0, 0}, {0, 1, 0}, {0, 0, 0}}), 1, 1), 0) << "a peak";
  EXPECT_EQ(BinaryPattern(GridOf({{0, 0, 0}, {5, 5, 5}, {9, 9, 9}}), 1, 1), 5) << "an edge";
  EXPECT_EQ(BinaryPattern(GridOf({{0, 9, 0}, {0, 5, 0}, {0, 9, 0}}), 1, 1), 9) << "a bar of two ends";
}

Grid<float> Rotated(const Grid<float>& image) {
  Grid<float> rotated(image.cols(), image.rows());
  for (int row = 0; row < image.rows(); ++row) {
    for (int col = 0; col < image.cols(); ++col) rotated(image.cols() - 1 - col, row) = image(row, col);
  }
  return rotated;
}

TEST(TextureTest, PatternsDoNotChangeWithRotationGainAndOffset) {
  const Grid<float> image = SpeckledBlock(4, 40.0).value;
  const Grid<float> rotated = Rotated(image);
  for (int row = 1; row + 1 < image.rows(); ++row) {
    for (int col = 1; col + 1 < image.cols(); ++col) {
      ASSERT_EQ(BinaryPattern(image, row, col), BinaryPattern(rotated, image.cols() - 1 - col, row));
    }
  }
  Grid<float> louder = image;
  for (float& value : louder.values()) value = 2.0F * value + 16.0F;
  const Mask none(image.rows(), image.cols());
  EXPECT_EQ(MeasureTexture(image, louder, none, none).whole.divergence(), 0.0);
}

TEST(TextureTest, DivergenceIsKullbackAndLeiblersWithHalfACountAdded) {
  TextureCounts counts;
  EXPECT_FALSE(counts.divergence());
  counts.real[0] = 10;
  counts.simulated[8] = 10;
  const double high = 10.5 / 15.0, low = 0.5 / 15.0;
  EXPECT_NEAR(counts.divergence().value(), high * std::log(high / low) + low * std::log(low / high), 1e-12);
  counts.simulated = counts.real;
  EXPECT_EQ(counts.divergence(), 0.0);
}

TEST(TextureTest, CountsWholeNeighbourhoodsOfTheDomain) {
  const Grid<float> image = SpeckledBlock(5, 40.0).value;
  Mask real(image.rows(), image.cols()), simulated = real, inside(image.rows(), image.cols(), 1);
  real(0, 0) = real(60, 20) = simulated(60, 20) = simulated(61, 20) = 1;
  const auto total = [](const TextureCounts& counts) {
    std::int64_t sum = 0;
    for (const std::int64_t count : counts.real) sum += count;
    return sum;
  };
  TextureMeasures texture = MeasureTexture(image, image, real, simulated);
  EXPECT_EQ(total(texture.whole), 118 * 38);
  EXPECT_EQ(total(texture.union_region), 2);
  inside(80, 20) = 0;
  EXPECT_EQ(total(MeasureTexture(image, image, real, simulated, &inside).whole), 118 * 38 - 9);
  texture += texture;
  EXPECT_EQ(total(texture.union_region), 4);
}

TEST(TextureTest, SpeckleDiffersFromASmoothImage) {
  const Grid<float> speckled = SpeckledBlock(6, 40.0).value;
  const Grid<float> other = SpeckledBlock(7, 40.0).value;
  const Grid<float> smooth(120, 40, 100.0F);
  const Mask none(120, 40);
  const double alike = MeasureTexture(speckled, other, none, none).whole.divergence().value();
  EXPECT_LT(alike, 0.02) << "two samples of one law";
  EXPECT_GT(MeasureTexture(speckled, smooth, none, none).whole.divergence().value(), 1.0);
}

}  // namespace
}  // namespace sonarcal::metrics
