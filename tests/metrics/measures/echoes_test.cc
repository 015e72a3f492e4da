#include "metrics/measures/echoes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using testing::GridOf;
using testing::MaskOf;
using testing::SpeckledBlock;

// The definitions, pixel by pixel.
EchoCounts SlowCounts(const Grid<float>& real, const Grid<float>& simulated, double level,
                      const Mask* inside) {
  const auto is_echo = [&](const Grid<float>& image, int row, int col) {
    return (inside == nullptr || (*inside)(row, col) != 0) && image(row, col) > level;
  };
  const auto is_near = [&](const Grid<float>& image, int row, int col) {
    for (int r = 0; r < image.rows(); ++r) {
      for (int c = 0; c < image.cols(); ++c) {
        if (std::hypot(r - row, c - col) <= 2.0 && is_echo(image, r, c)) return true;
      }
    }
    return false;
  };
  EchoCounts counts;
  for (int row = 0; row < real.rows(); ++row) {
    for (int col = 0; col < real.cols(); ++col) {
      if (is_echo(real, row, col)) {
        ++counts.real;
        counts.real_near_simulated += is_near(simulated, row, col);
      }
      if (is_echo(simulated, row, col)) {
        ++counts.simulated;
        counts.simulated_near_real += is_near(real, row, col);
      }
    }
  }
  return counts;
}

void ExpectEqual(const EchoCounts& fast, const EchoCounts& slow) {
  EXPECT_EQ(fast.real, slow.real);
  EXPECT_EQ(fast.simulated, slow.simulated);
  EXPECT_EQ(fast.real_near_simulated, slow.real_near_simulated);
  EXPECT_EQ(fast.simulated_near_real, slow.simulated_near_real);
}

TEST(EchoesTest, AgreesWithItsDefinitionPixelByPixel) {
  const Grid<float> x = SpeckledBlock(1).value;
  const Grid<float> y = SpeckledBlock(2, 23.0).value;
  Mask inside(x.rows(), x.cols(), 1);
  for (int row = 20; row < 50; ++row) inside(row, 12) = 0;
  for (const double level : {60.0, 130.0, 160.0}) {
    ExpectEqual(CountEchoes(x, y, level), SlowCounts(x, y, level, nullptr));
    ExpectEqual(CountEchoes(x, y, level, &inside), SlowCounts(x, y, level, &inside));
  }
}

TEST(EchoesTest, TheTolerancesReachesTwoPixelsFromCentreToCentre) {
  Grid<float> real(9, 9), at_two(9, 9), diagonal(9, 9), at_three(9, 9);
  real(4, 4) = at_two(4, 6) = diagonal(6, 6) = at_three(7, 4) = 10.0F;
  EXPECT_EQ(CountEchoes(real, at_two, 5.0).matched_real(), 1.0);
  EXPECT_EQ(CountEchoes(real, diagonal, 5.0).matched_real(), 0.0);
  EXPECT_EQ(CountEchoes(real, at_three, 5.0).matched_simulated(), 0.0);
}

TEST(EchoesTest, RatiosCountPixelsAboveTheLevel) {
  const Grid<float> real = GridOf({{5, 6, 9, 0, 0, 0, 0, 9}});
  const Grid<float> simulated = GridOf({{9, 9, 9, 9, 0, 0, 0, 0}});
  EchoCounts counts = CountEchoes(real, simulated, 5.0);
  EXPECT_DOUBLE_EQ(counts.coverage_ratio().value(), 4.0 / 3.0);
  EXPECT_DOUBLE_EQ(counts.matched_real().value(), 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(counts.matched_simulated().value(), 1.0);
  counts += CountEchoes(simulated, real, 5.0);
  EXPECT_DOUBLE_EQ(counts.coverage_ratio().value(), 1.0) << "pooled";
  EXPECT_DOUBLE_EQ(counts.matched_real().value(), (2.0 + 4.0) / 7.0);
  EXPECT_DOUBLE_EQ(counts.matched_simulated().value(), (4.0 + 2.0) / 7.0);
}

TEST(EchoesTest, WithoutEchoesThereIsNoRatio) {
  const Grid<float> dark(3, 3, 7.0F);
  EXPECT_EQ(EchoLevel(dark), 7.0) << "nothing is above the only level";
  const Mask none = MaskOf({"...", "...", "..."});
  const EchoCounts counts = CountEchoes(dark, dark, EchoLevel(dark, &none), &none);
  EXPECT_FALSE(counts.coverage_ratio());
  EXPECT_FALSE(counts.matched_real());
  EXPECT_FALSE(counts.matched_simulated());
}

TEST(EchoesTest, TheLevelSeparatesTwoClassesOfTheValidPixels) {
  const Grid<float> real = GridOf({{10, 12, 11, 80, 82, 255}});
  const Mask inside = MaskOf({"#####."});
  EXPECT_EQ(EchoLevel(real, &inside), 12.0);
}

}  // namespace
}  // namespace sonarcal::metrics
