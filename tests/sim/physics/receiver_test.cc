#include "sim/physics/receiver.h"

#include <gtest/gtest.h>

namespace sonarcal::sim {
namespace {

constexpr double kEulerGamma = 0.57721566490153286;

// psi(n) = -gamma + 1 + 1/2 + ... + 1/(n - 1); psi(1/2) = -gamma - 2 ln 2, psi(x + 1) = psi(x) + 1/x.
TEST(Speckle, MeanOfTheLogarithm) {
  const double db = 10.0 / std::log(10.0);
  EXPECT_NEAR(MeanLogSpeckleDb(1.0), -2.507, 5e-4);
  EXPECT_NEAR(MeanLogSpeckleDb(1.0), -db * kEulerGamma, 1e-12);
  EXPECT_NEAR(MeanLogSpeckleDb(3.0), db * (1.5 - kEulerGamma - std::log(3.0)), 1e-12);
  EXPECT_NEAR(MeanLogSpeckleDb(1.5), db * (2.0 - kEulerGamma - std::log(4.0) - std::log(1.5)), 1e-12);
  EXPECT_LT(MeanLogSpeckleDb(1.0), MeanLogSpeckleDb(1.1));
  EXPECT_NEAR(MeanLogSpeckleDb(1e6), -db * 0.5e-6, 1e-9);
}

TEST(Speckle, WeightsHaveTheVarianceOfTheLooks) {
  for (int i = 0; i <= 200; ++i) {
    const double looks = 1.0 + 0.05 * i;
    const auto [whole, weight] = LooksAsWeights(looks);
    const double sum = whole + weight;
    ASSERT_GE(weight, 0.0) << looks;
    ASSERT_LT(weight, 1.0) << looks;
    EXPECT_NEAR((whole + weight * weight) / (sum * sum), 1.0 / looks, 1e-12) << looks;
  }
  EXPECT_EQ(LooksAsWeights(1.0), std::make_pair(1, 0.0));
  EXPECT_EQ(LooksAsWeights(4.0), std::make_pair(4, 0.0));
}

TEST(TimeVariedGainTest, GrowsAsItsNameSays) {
  EXPECT_EQ(TimeVariedGainDb(TimeVariedGain::kNone, 7.0, 0.3), 0.0);
  EXPECT_NEAR(TimeVariedGainDb(TimeVariedGain::k20LogR, 10.0, 0.3), 20.0, 1e-12);
  EXPECT_NEAR(TimeVariedGainDb(TimeVariedGain::k40LogR, 10.0, 0.3), 40.0, 1e-12);
  EXPECT_NEAR(TimeVariedGainDb(TimeVariedGain::k40LogRAndAbsorption, 10.0, 0.3), 46.0, 1e-12);
}

TEST(NoisePowerTest, AddsTheFloorsBeforeAndBehindTheGain) {
  ReceiverParameters receiver;
  EXPECT_EQ(NoisePower(receiver, 5.0, 0, 0.0), 0.0);
  receiver.noise_db = 20.0;
  receiver.noise_slope_db_per_m = -2.0;
  receiver.noise_taper_db = {0.0, 10.0};
  EXPECT_NEAR(NoisePower(receiver, 5.0, 0, 0.0), 10.0, 1e-12);
  EXPECT_NEAR(NoisePower(receiver, 5.0, 1, 0.0), 100.0, 1e-11);
  receiver.time_varied_gain = TimeVariedGain::k20LogR;
  EXPECT_NEAR(NoisePower(receiver, 5.0, 1, 0.0), 2500.0, 1e-9);
  receiver.noise_after_gain_db = 30.0;
  receiver.noise_after_gain_taper_db = {0.0, -10.0};
  EXPECT_NEAR(NoisePower(receiver, 5.0, 1, 0.0), 2600.0, 1e-9);  // power, not levels, and no gain on it
  EXPECT_NO_THROW(CheckTapers(receiver, 2));
  EXPECT_THROW(CheckTapers(receiver, 3), DataError);
}

TEST(ReceiverNoiseTest, IsTheNoisePowerOfEveryPixel) {
  PolarAxes axes{
      .range_min_m = 1.0, .range_max_m = 9.0, .range_bins = 16, .beam_azimuth_rad = {-0.1, 0.0, 0.1}};
  ReceiverParameters receiver;
  receiver.noise_db = 20.0;
  receiver.noise_slope_db_per_m = -0.7;
  receiver.noise_taper_db = {0.0, 3.0, -4.0};
  receiver.time_varied_gain = TimeVariedGain::k20LogR;
  receiver.noise_after_gain_db = 30.0;
  receiver.noise_after_gain_taper_db = {1.0, -10.0, 2.0};
  const ReceiverNoise fast(receiver, axes, 0.2);
  for (int bin = 0; bin < axes.range_bins; ++bin) {
    for (int beam = 0; beam < axes.beam_count(); ++beam) {
      const double slow = NoisePower(receiver, axes.range_centre_m(bin), beam, 0.2);
      EXPECT_NEAR(fast.Power(bin, beam), slow, 1e-12 * slow) << bin << ", " << beam;
    }
  }
}

TEST(ReceiverNoiseTest, IsEvenWithoutATaper) {
  ReceiverParameters receiver;
  receiver.noise_db = 20.0;
  const PolarAxes axes{
      .range_min_m = 1.0, .range_max_m = 2.0, .range_bins = 2, .beam_azimuth_rad = {-0.1, 0.0, 0.1}};
  const ReceiverNoise noise(receiver, axes, 0.0);
  for (int beam = 0; beam < 3; ++beam) EXPECT_NEAR(noise.Power(1, beam), 100.0, 1e-9);
}

TEST(Speckle, FewerThanOneLookCannotBeDrawn) {
  EXPECT_NO_THROW(CheckLooksToDraw(1.0));
  EXPECT_NO_THROW(CheckLooksToDraw(1.7));
  EXPECT_THROW(CheckLooksToDraw(0.999), DataError);
}

}  // namespace
}  // namespace sonarcal::sim
