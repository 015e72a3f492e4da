#include "metrics/false_alarms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "core/types/error.h"
#include "metrics/segmentation/segmentation.h"
#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

constexpr double kPingSpanDb = 80.0;
constexpr double kMeanPower = 1e4;  // 40 dB above 0, in the middle of the display
constexpr int kPingBins = 200;
constexpr int kPingBeams = 96;

// Exponential power of one mean, shown over 80 dB without steps.
PolarImage Ping(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::exponential_distribution<double> power;
  PolarImage ping{testing::SmallAxes(kPingBins, kPingBeams), {}, Grid<float>(kPingBins, kPingBeams)};
  for (float& value : ping.value.values()) {
    const double level_db = 10.0 * std::log10(kMeanPower * power(random));
    value = static_cast<float>(255.0 * std::clamp(level_db / kPingSpanDb, 0.0, 1.0));
  }
  return ping;
}

SegmentationOptions WithLaw() {
  SegmentationOptions options;
  options.background_law = std::make_shared<BackgroundLaw>(BackgroundLaw{
      Grid<float>(kPingBins, kPingBeams, static_cast<float>(kMeanPower)), 1.0, LogDisplayPower(kPingSpanDb)});
  return options;
}

FalseAlarmRate RateOf(const std::vector<FalseAlarmRate>& rates, SegmentationMethod method,
                      std::optional<double> stated = {}) {
  const auto found = std::ranges::find_if(
      rates, [&](const FalseAlarmRate& rate) { return rate.method == method && rate.stated == stated; });
  EXPECT_NE(found, rates.end()) << ToString(method);
  return *found;
}

// The tolerance is five standard errors of a share of 192,000 independent pixels.
TEST(FalseAlarmsTest, StatedRatesAreRealisedWhereTheLawHolds) {
  FalseAlarmCounter counter(WithLaw(), {0.1, 0.01});
  for (int i = 0; i < 10; ++i) counter.Add(Ping(i + 1), nullptr);
  const std::vector<FalseAlarmRate> rates = counter.Rates();
  EXPECT_EQ(rates.size(), 5U + 3U * 2U);
  for (const SegmentationMethod method :
       {SegmentationMethod::kLikelihoodRatio, SegmentationMethod::kCaCfar, SegmentationMethod::kOsCfar}) {
    for (const double stated : {0.1, 0.01}) {
      const FalseAlarmRate rate = RateOf(rates, method, stated);
      EXPECT_EQ(rate.pixels, 10 * kPingBins * kPingBeams);
      const double sigma = std::sqrt(stated * (1.0 - stated) / static_cast<double>(rate.pixels));
      EXPECT_NEAR(rate.realised(), stated, 5.0 * sigma) << ToString(method);
      ASSERT_TRUE(rate.ci);
      EXPECT_LE(rate.ci->lo, rate.realised());
      EXPECT_GE(rate.ci->hi, rate.realised());
      EXPECT_LT(rate.ci->hi - rate.ci->lo, 0.2 * stated);
    }
  }
}

TEST(FalseAlarmsTest, AFixedThresholdHasTheRateOfTheLaw) {
  SegmentationOptions options = WithLaw();
  options.blur_rows = options.blur_cols = 0.0;
  options.threshold_fraction = 45.0 / kPingSpanDb;  // 5 dB above the mean
  FalseAlarmCounter counter(options, {0.1});
  for (int i = 0; i < 5; ++i) counter.Add(Ping(i + 1), nullptr);
  const FalseAlarmRate rate = RateOf(counter.Rates(), SegmentationMethod::kFixedThreshold);
  EXPECT_FALSE(rate.stated);
  const double expected = std::exp(-std::pow(10.0, 0.5));
  EXPECT_NEAR(rate.realised(), expected, 5.0 * std::sqrt(expected / static_cast<double>(rate.pixels)));
}

TEST(FalseAlarmsTest, CountsThePixelsOfASegmentationWithoutTidyingInTheRegion) {
  Mask region(kPingBins, kPingBeams);
  for (int bin = 20; bin < 150; ++bin) {
    for (int beam = 0; beam < kPingBeams; ++beam) region(bin, beam) = 1;
  }
  SegmentationOptions options = WithLaw();
  options.sigma_count = 2.0;
  FalseAlarmCounter counter(options, {0.05});
  counter.Add(Ping(1), &region);
  options.close_rows = options.close_cols = 0;
  options.largest_component_only = false;
  for (const FalseAlarmRate& rate : counter.Rates()) {
    options.method = rate.method;
    if (rate.stated) options.false_alarm_rate = *rate.stated;
    EXPECT_EQ(rate.alarms, CountSet(Segment(Ping(1), options, &region).object)) << ToString(rate.method);
    EXPECT_EQ(rate.pixels, 130 * kPingBeams);
    EXPECT_FALSE(rate.ci) << "one ping";
  }
}

TEST(FalseAlarmsTest, WithoutALawThereIsNoLikelihoodRatioAndRatesAreChecked) {
  const FalseAlarmCounter counter({}, {0.1});
  for (const FalseAlarmRate& rate : counter.Rates()) {
    EXPECT_NE(rate.method, SegmentationMethod::kLikelihoodRatio);
    EXPECT_EQ(rate.realised(), 0.0);
  }
  EXPECT_THROW(FalseAlarmCounter({}, {0.0}), DataError);
}

}  // namespace
}  // namespace sonarcal::metrics
