#include "metrics/measures/occupancy.h"

#include <gtest/gtest.h>

#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using testing::MaskOf;

const Mask& Real() {
  static const Mask kMask = MaskOf({"####", "##..", "...."});
  return kMask;
}
const Mask& Simulated() {
  static const Mask kMask = MaskOf({".###", "....", "...#"});
  return kMask;
}

TEST(OccupancyTest, CountsAndRatiosEqualThoseByHand) {
  const Occupancy counts = CountOccupancy(Real(), Simulated());
  EXPECT_EQ(counts, (Occupancy{.ns = 4, .nr = 6, .na = 3}));
  EXPECT_EQ(counts.union_count(), 7);
  EXPECT_DOUBLE_EQ(counts.ns_over_nr().value(), 4.0 / 6.0);
  EXPECT_DOUBLE_EQ(counts.na_over_ns().value(), 3.0 / 4.0);
  EXPECT_DOUBLE_EQ(counts.na_over_nr().value(), 3.0 / 6.0);
  EXPECT_DOUBLE_EQ(counts.iou().value(), 3.0 / 7.0);
  EXPECT_DOUBLE_EQ(counts.dice().value(), 6.0 / 10.0);
}

TEST(OccupancyTest, SwappingRealAndSimulatedMirrorsTheRatios) {
  const Occupancy ab = CountOccupancy(Real(), Simulated());
  const Occupancy ba = CountOccupancy(Simulated(), Real());
  EXPECT_DOUBLE_EQ(ba.ns_over_nr().value(), 1.0 / ab.ns_over_nr().value());
  EXPECT_EQ(ba.na_over_ns(), ab.na_over_nr());
  EXPECT_EQ(ba.na_over_nr(), ab.na_over_ns());
  EXPECT_EQ(ba.iou(), ab.iou());
}

TEST(OccupancyTest, EqualMasksGiveOnes) {
  const Occupancy counts = CountOccupancy(Real(), Real());
  EXPECT_EQ(counts.ns_over_nr(), 1.0);
  EXPECT_EQ(counts.na_over_ns(), 1.0);
  EXPECT_EQ(counts.na_over_nr(), 1.0);
  EXPECT_EQ(counts.iou(), 1.0);
}

TEST(OccupancyTest, ARatioOverNothingHasNoValue) {
  const Mask empty(3, 4);
  const Occupancy no_real = CountOccupancy(empty, Simulated());
  EXPECT_EQ(no_real.ns_over_nr(), std::nullopt);
  EXPECT_EQ(no_real.na_over_nr(), std::nullopt);
  EXPECT_EQ(no_real.na_over_ns(), 0.0);
  EXPECT_EQ(no_real.iou(), 0.0);
  EXPECT_EQ(no_real.dice(), 0.0);
  EXPECT_EQ(CountOccupancy(empty, empty).iou(), std::nullopt);
  EXPECT_EQ(CountOccupancy(empty, empty).dice(), std::nullopt);
}

TEST(OccupancyTest, PooledFramesAddTheirCounts) {
  Occupancy pooled = CountOccupancy(Real(), Simulated());
  pooled += {.ns = 10, .nr = 20, .na = 5};
  EXPECT_EQ(pooled, (Occupancy{.ns = 14, .nr = 26, .na = 8}));
}

TEST(OccupancyTest, MasksOfDifferentShapeAreAProgrammersMistake) {
  EXPECT_THROW(CountOccupancy(Mask(2, 3), Mask(3, 2)), std::logic_error);
}

}  // namespace
}  // namespace sonarcal::metrics
