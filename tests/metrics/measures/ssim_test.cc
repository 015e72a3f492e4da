#include "metrics/measures/ssim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using testing::SpeckledBlock;

// Wang 2004, Eqs. 13-16, window by window.
SsimSum SlowSsim(const Grid<float>& x, const Grid<float>& y, double full_scale, const Mask* inside) {
  double weight[11][11];
  double sum = 0.0;
  for (int i = 0; i < 11; ++i) {
    for (int j = 0; j < 11; ++j) {
      weight[i][j] = std::exp(-((i - 5) * (i - 5) + (j - 5) * (j - 5)) / (2.0 * 1.5 * 1.5));
      sum += weight[i][j];
    }
  }
  SsimSum ssim;
  for (int row = 0; row + 11 <= x.rows(); ++row) {
    for (int col = 0; col + 11 <= x.cols(); ++col) {
      const auto mean = [&](auto of) {
        double total = 0.0;
        for (int i = 0; i < 11; ++i) {
          for (int j = 0; j < 11; ++j) total += weight[i][j] / sum * of(row + i, col + j);
        }
        return total;
      };
      if (inside != nullptr && mean([&](int r, int c) { return (*inside)(r, c); }) < 1.0 - 1e-12) continue;
      const double mx = mean([&](int r, int c) { return x(r, c); });
      const double my = mean([&](int r, int c) { return y(r, c); });
      const double vx = mean([&](int r, int c) { return (x(r, c) - mx) * (x(r, c) - mx); });
      const double vy = mean([&](int r, int c) { return (y(r, c) - my) * (y(r, c) - my); });
      const double xy = mean([&](int r, int c) { return (x(r, c) - mx) * (y(r, c) - my); });
      const double c1 = std::pow(0.01 * full_scale, 2), c2 = std::pow(0.03 * full_scale, 2);
      ssim.sum += (2 * mx * my + c1) * (2 * xy + c2) / ((mx * mx + my * my + c1) * (vx + vy + c2));
      ++ssim.windows;
    }
  }
  return ssim;
}

TEST(SsimTest, AgreesWithItsFormulaWindowByWindow) {
  const Grid<float> x = SpeckledBlock(1, 40.0).value;
  const Grid<float> y = SpeckledBlock(2, 42.0).value;
  const Mask none(x.rows(), x.cols());
  const SsimSum fast = MeasureSsim(x, y, 255.0, none, none).whole;
  const SsimSum slow = SlowSsim(x, y, 255.0, nullptr);
  EXPECT_EQ(fast.windows, slow.windows);
  EXPECT_NEAR(fast.mean().value(), slow.mean().value(), 1e-9);

  Mask inside(x.rows(), x.cols(), 1);
  for (int row = 0; row < 50; ++row) inside(row, 20) = 0;
  const SsimSum fast_inside = MeasureSsim(x, y, 255.0, none, none, &inside).whole;
  const SsimSum slow_inside = SlowSsim(x, y, 255.0, &inside);
  EXPECT_EQ(fast_inside.windows, slow_inside.windows);
  EXPECT_LT(fast_inside.windows, fast.windows);
  EXPECT_NEAR(fast_inside.mean().value(), slow_inside.mean().value(), 1e-9);
}

TEST(SsimTest, EqualImagesScoreOneAndEvenOnesTheLuminanceTerm) {
  const Grid<float> x = SpeckledBlock(1).value;
  const Mask none(x.rows(), x.cols());
  EXPECT_NEAR(MeasureSsim(x, x, 255.0, none, none).whole.mean().value(), 1.0, 1e-12);
  const Grid<float> dark(20, 20, 50.0f), bright(20, 20, 100.0f);
  const Mask some(20, 20);
  const double c1 = 2.55 * 2.55;
  EXPECT_NEAR(MeasureSsim(dark, bright, 255.0, some, some).whole.mean().value(),
              (2.0 * 50.0 * 100.0 + c1) / (50.0 * 50.0 + 100.0 * 100.0 + c1), 1e-9);
}

TEST(SsimTest, TheUnionHoldsWindowsWhoseMiddleIsObject) {
  const Grid<float> x = SpeckledBlock(1).value;
  Mask real(x.rows(), x.cols()), simulated = real;
  real(60, 20) = real(0, 0) = 1;  // no window has its middle in the corner
  simulated(61, 20) = 1;
  const StructuralSimilarity ssim = MeasureSsim(x, x, 255.0, real, simulated);
  EXPECT_EQ(ssim.union_region.windows, 2);
  EXPECT_EQ(ssim.whole.windows, 110 * 30);
}

TEST(SsimTest, FramesArePooledByTheirWindows) {
  SsimSum sum{.windows = 3, .sum = 1.5};
  sum += SsimSum{.windows = 1, .sum = 0.9};
  EXPECT_EQ(sum.windows, 4);
  EXPECT_DOUBLE_EQ(sum.mean().value(), 0.6);
}

TEST(SsimTest, AnImageSmallerThanAWindowHasNoValue) {
  const Grid<float> small(10, 40, 3.0f);
  const Mask none(10, 40);
  EXPECT_FALSE(MeasureSsim(small, small, 255.0, none, none).whole.mean());
  const Grid<float> narrow(40, 10, 3.0f), one_window(11, 11, 3.0f);
  EXPECT_FALSE(MeasureSsim(narrow, narrow, 255.0, Mask(40, 10), Mask(40, 10)).whole.mean());
  EXPECT_EQ(MeasureSsim(one_window, one_window, 255.0, Mask(11, 11), Mask(11, 11)).whole.windows, 1);
}

}  // namespace
}  // namespace sonarcal::metrics
