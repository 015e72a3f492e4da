#include "metrics/measures/intensity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using testing::GridOf;
using testing::MaskOf;

// d = 0.1, -0.2, 0.3, 0.4 of full scale.
const Grid<float> kReal = GridOf({{10.0f, 40.0f, 0.0f, 20.0f}});
const Grid<float> kSimulated = GridOf({{20.0f, 20.0f, 30.0f, 60.0f}});

TEST(IntensityTest, ErrorsOverEachDomainEqualThoseByHand) {
  const IntensityError error =
      MeasureIntensityError(kReal, kSimulated, 100.0, MaskOf({"##.."}), MaskOf({".##."}));
  EXPECT_EQ(error.whole.pixels, 4);
  EXPECT_NEAR(error.whole.mean_absolute().value(), 1.0 / 4.0, 1e-12);
  EXPECT_NEAR(error.whole.bias().value(), 0.6 / 4.0, 1e-12);
  EXPECT_NEAR(error.whole.rmse().value(), std::sqrt((0.01 + 0.04 + 0.09 + 0.16) / 4.0), 1e-12);

  EXPECT_EQ(error.union_region.pixels, 3);
  EXPECT_NEAR(error.union_region.mean_absolute().value(), 0.6 / 3.0, 1e-12);
  EXPECT_NEAR(error.union_region.bias().value(), 0.2 / 3.0, 1e-12);

  EXPECT_EQ(error.overlap.pixels, 1);
  EXPECT_NEAR(error.overlap.mean_absolute().value(), 0.2, 1e-12);
  EXPECT_NEAR(error.overlap.bias().value(), -0.2, 1e-12);
}

TEST(IntensityTest, EqualImagesHaveNoErrorAndAnEmptyDomainNoValue) {
  const IntensityError error = MeasureIntensityError(kReal, kReal, 100.0, MaskOf({"##.."}), MaskOf({"..##"}));
  EXPECT_EQ(error.whole.mean_absolute(), 0.0);
  EXPECT_EQ(error.union_region.rmse(), 0.0);
  EXPECT_EQ(error.overlap.mean_absolute(), std::nullopt);
  EXPECT_EQ(error.overlap.rmse(), std::nullopt);
  EXPECT_EQ(error.overlap.bias(), std::nullopt);
}

TEST(IntensityTest, SwappingTheImagesTurnsTheBiasAndNothingElse) {
  const Mask all = MaskOf({"####"});
  const IntensityError ab = MeasureIntensityError(kReal, kSimulated, 100.0, all, all);
  const IntensityError ba = MeasureIntensityError(kSimulated, kReal, 100.0, all, all);
  EXPECT_EQ(ab.whole.mean_absolute(), ba.whole.mean_absolute());
  EXPECT_EQ(ab.whole.rmse(), ba.whole.rmse());
  EXPECT_EQ(*ab.whole.bias(), -*ba.whole.bias());
}

TEST(IntensityTest, PixelsOutsideTheFanCountNowhere) {
  const Mask all = MaskOf({"####"});
  const Mask inside = MaskOf({"#..."});
  const IntensityError error = MeasureIntensityError(kReal, kSimulated, 100.0, all, all, &inside);
  EXPECT_EQ(error.whole.pixels, 1);
  EXPECT_EQ(error.union_region.pixels, 1);
  EXPECT_NEAR(error.overlap.mean_absolute().value(), 0.1, 1e-12);
}

TEST(IntensityTest, PoolingTwoFramesIsMeasuringThemAsOne) {
  const Mask a = MaskOf({"##.."}), b = MaskOf({".##."});
  IntensityError pooled = MeasureIntensityError(kReal, kSimulated, 100.0, a, b);
  pooled += MeasureIntensityError(kSimulated, kReal, 100.0, b, a);
  EXPECT_EQ(pooled.union_region.pixels, 6);
  EXPECT_NEAR(pooled.union_region.mean_absolute().value(), 0.2, 1e-12);
  EXPECT_NEAR(pooled.union_region.bias().value(), 0.0, 1e-12);
}

TEST(IntensityTest, EverySumOfPooledFramesAddsUp) {
  const Mask all = MaskOf({"####"});
  const IntensityError one = MeasureIntensityError(kReal, kSimulated, 100.0, all, all);
  IntensityError three = one;
  three += one;
  three += one;
  EXPECT_EQ(three.whole.pixels, 12);
  EXPECT_NEAR(three.whole.rmse().value(), one.whole.rmse().value(), 1e-12);
  EXPECT_NEAR(three.overlap.relative().value(), one.overlap.relative().value(), 1e-12);
  EXPECT_NEAR(three.whole.correlation().value(), one.whole.correlation().value(), 1e-12);
  EXPECT_NEAR(three.objects.mean_difference().value(), one.objects.mean_difference().value(), 1e-12);
  EXPECT_EQ(three.objects.real_pixels, 12);
  EXPECT_EQ(three.objects.simulated_pixels, 12);
}

TEST(IntensityTest, DerivedErrorsEqualThoseByHand) {
  const IntensityError error =
      MeasureIntensityError(kReal, kSimulated, 100.0, MaskOf({"##.."}), MaskOf({".##."}));
  EXPECT_NEAR(error.whole.relative().value(), 1.0 / 0.7, 1e-12);
  EXPECT_NEAR(error.union_region.relative().value(), 0.6 / 0.5, 1e-12);
  EXPECT_NEAR(error.objects.mean_difference().value(), 0.25 - 0.25, 1e-12);  // (.2 + .3) / 2, (.1 + .4) / 2
  EXPECT_NEAR(PsnrDb(error.whole.mean_square().value()).value(), 10.0 * std::log10(4.0 / 0.3), 1e-12);
  EXPECT_FALSE(PsnrDb(0.0));

  // Pearson's r of (.1, .4, 0, .2) and (.2, .2, .3, .6), from centred values.
  const double r[] = {-0.075, 0.225, -0.175, 0.025}, s[] = {-0.125, -0.125, -0.025, 0.275};
  double rs = 0.0, rr = 0.0, ss = 0.0;
  for (int i = 0; i < 4; ++i) {
    rs += r[i] * s[i];
    rr += r[i] * r[i];
    ss += s[i] * s[i];
  }
  EXPECT_NEAR(error.whole.correlation().value(), rs / std::sqrt(rr * ss), 1e-12);
  EXPECT_FALSE(error.overlap.correlation()) << "one pixel does not vary";
}

TEST(IntensityTest, CorrelationIsBlindToGainAndOffset) {
  Grid<float> scaled = kReal;
  for (float& value : scaled.values()) value = 20.0f + 0.5f * value;
  const Mask all = MaskOf({"####"});
  EXPECT_NEAR(MeasureIntensityError(kReal, scaled, 100.0, all, all).whole.correlation().value(), 1.0, 1e-9);
  // Dark images vary as much, for their level.
  Grid<float> dark = kSimulated;
  for (float& value : dark.values()) value *= 1e-5f;
  EXPECT_NEAR(MeasureIntensityError(kReal, dark, 100.0, all, all).whole.correlation().value(),
              MeasureIntensityError(kReal, kSimulated, 100.0, all, all).whole.correlation().value(), 1e-6);
  EXPECT_NEAR(MeasureIntensityError(dark, kReal, 100.0, all, all).whole.correlation().value(),
              MeasureIntensityError(kReal, kSimulated, 100.0, all, all).whole.correlation().value(), 1e-6);
  const Grid<float> even(1, 4, 50.0f), black(1, 4);
  EXPECT_FALSE(MeasureIntensityError(kReal, even, 100.0, all, all).whole.correlation());
  EXPECT_FALSE(MeasureIntensityError(black, kReal, 100.0, all, all).whole.relative());
}

TEST(IntensityTest, ObjectsOfDifferentPlacesCompareByTheirMeans) {
  const IntensityError error =
      MeasureIntensityError(kReal, kSimulated, 100.0, MaskOf({".#.."}), MaskOf({"...#"}));
  EXPECT_NEAR(error.objects.mean_difference().value(), 0.6 - 0.4, 1e-12);
  EXPECT_FALSE(MeasureIntensityError(kReal, kSimulated, 100.0, MaskOf({"...."}), MaskOf({"...#"}))
                   .objects.mean_difference());
}

TEST(IntensityTest, EachDomainSelectsItsOwnError) {
  IntensityError error;
  error.whole.pixels = 1;
  error.overlap.pixels = 2;
  error.union_region.pixels = 3;
  EXPECT_EQ(error.Over(IntensityDomain::kWhole).pixels, 1);
  EXPECT_EQ(error.Over(IntensityDomain::kOverlap).pixels, 2);
  EXPECT_EQ(error.Over(IntensityDomain::kUnion).pixels, 3);
  EXPECT_EQ(ToString(IntensityDomain::kUnion), "union");
}

}  // namespace
}  // namespace sonarcal::metrics
