#include "metrics/measures/residuals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using ::testing::HasSubstr;
using testing::MaskOf;

PolarImage ImageOf(int bins, int beams, float value) {
  ImageScale scale;
  scale.full_scale = 100.0;
  return {testing::SmallAxes(bins, beams), scale, Grid<float>(bins, beams, value)};
}

TEST(ResidualsTest, AnErrorIsFoundAtItsRangeAndBeam) {
  const PolarImage real = ImageOf(4, 3, 50.0F);
  PolarImage simulated = real;
  for (int beam = 0; beam < 3; ++beam) simulated.value(2, beam) += 20.0F;
  simulated.value(0, 1) -= 10.0F;
  const Mask object = MaskOf({"...", "...", "#..", "..."});
  ResidualCollector residuals;
  residuals.Add(real, simulated, object, Mask(4, 3));
  residuals.Add(real, real, object, object);

  const ResidualTable by_range = residuals.ByRange();
  ASSERT_EQ(by_range.classes.size(), 4U);
  EXPECT_NEAR(*by_range.classes[2].from, 2.0, 1e-12);  // 1 .. 3 m in four bins
  EXPECT_NEAR(*by_range.classes[2].to, 2.5, 1e-12);
  EXPECT_EQ(by_range.classes[2].sums.whole.pixels, 6);
  EXPECT_NEAR(*by_range.classes[2].sums.whole.bias(), 0.1, 1e-7);
  EXPECT_EQ(by_range.classes[2].sums.union_region.pixels, 2);
  EXPECT_NEAR(*by_range.classes[0].sums.whole.bias(), -0.1 / 6.0, 1e-7);
  EXPECT_EQ(*by_range.classes[3].sums.whole.mean_absolute(), 0.0);
  EXPECT_FALSE(by_range.classes[3].sums.union_region.bias());

  const ResidualTable by_beam = residuals.ByBeam();
  ASSERT_EQ(by_beam.classes.size(), 3U);
  EXPECT_NEAR(*by_beam.classes[1].sums.whole.bias(), 0.1 / 8.0, 1e-7);
  EXPECT_NEAR(*by_beam.classes[1].sums.whole.mean_absolute(), 0.3 / 8.0, 1e-7);
  EXPECT_NEAR(*by_beam.classes[1].from, -0.01 * 180.0 / 3.14159265358979, 1e-9);
  EXPECT_NEAR(*by_beam.classes[1].to, 0.01 * 180.0 / 3.14159265358979, 1e-9);
}

TEST(ResidualsTest, TheMapIsCoarseAndLosesNoPixel) {
  const PolarImage real = ImageOf(130, 70, 50.0F);
  PolarImage simulated = real;
  simulated.value(129, 69) = 100.0F;
  ResidualCollector residuals;
  residuals.Add(real, simulated, Mask(130, 70), Mask(130, 70));
  const ResidualMap& map = residuals.map();
  EXPECT_EQ(map.bins, 3);
  EXPECT_EQ(map.beams, 2);
  EXPECT_EQ(map.cells.rows(), 44);
  EXPECT_EQ(map.cells.cols(), 35);
  std::int64_t pixels = 0;
  for (const ResidualSums& sums : map.cells.values()) pixels += sums.whole.pixels;
  EXPECT_EQ(pixels, 130 * 70);
  EXPECT_EQ(map.cells(43, 34).whole.pixels, 2) << "the last row of cells holds one bin";
  EXPECT_NEAR(*map.cells(43, 34).whole.bias(), 0.25, 1e-7);

  const PolarImage whole_cells = ImageOf(129, 70, 50.0F);
  ResidualCollector of_whole_cells;
  of_whole_cells.Add(whole_cells, whole_cells, Mask(129, 70), Mask(129, 70));
  EXPECT_EQ(of_whole_cells.map().cells.rows(), 43);

  const PolarImage of_64 = ImageOf(64, 65, 50.0F);
  ResidualCollector of_64_bins;
  of_64_bins.Add(of_64, of_64, Mask(64, 65), Mask(64, 65));
  EXPECT_EQ(of_64_bins.map().bins, 1);
  EXPECT_EQ(of_64_bins.map().beams, 2);
}

TEST(ResidualsTest, FramesOfOtherAxesAreLeftOut) {
  ResidualCollector residuals;
  const PolarImage four = ImageOf(4, 3, 1.0F), five = ImageOf(5, 3, 1.0F);
  residuals.Add(four, four, Mask(4, 3), Mask(4, 3));
  residuals.Add(five, five, Mask(5, 3), Mask(5, 3));
  EXPECT_EQ(residuals.frames(), 1);
  EXPECT_EQ(residuals.frames_left_out(), 1);
}

// Collectors of parts of a recording, added, are the collector of the whole.
TEST(ResidualsTest, CollectorsAddUp) {
  PolarImage real = ImageOf(4, 3, 50.0F), brighter = ImageOf(4, 3, 60.0F), darker = ImageOf(4, 3, 20.0F);
  for (PolarImage* image : {&real, &brighter, &darker}) image->scale.full_scale = 128.0;  // sums are exact
  const PolarImage other_axes = ImageOf(5, 3, 50.0F);
  const Mask object = MaskOf({"...", "...", "#..", "..."}), none(4, 3);
  ResidualCollector whole, first, second;
  whole.Add(real, brighter, object, none);
  whole.Add(real, darker, object, none);
  whole.Add(other_axes, other_axes, Mask(5, 3), Mask(5, 3));
  first.Add(real, brighter, object, none);
  second.Add(real, darker, object, none);
  second.Add(other_axes, other_axes, Mask(5, 3), Mask(5, 3));
  ResidualCollector sum;
  sum += first;
  sum += second;
  EXPECT_EQ(sum.frames(), 2);
  EXPECT_EQ(sum.frames_left_out(), 1);
  EXPECT_EQ(ResidualsCsv({sum.ByRange(), sum.ByBeam()}), ResidualsCsv({whole.ByRange(), whole.ByBeam()}));
  for (int bin = 0; bin < 4; ++bin) {
    for (int beam = 0; beam < 3; ++beam) {
      EXPECT_EQ(sum.map().cells(bin, beam).whole.bias(), whole.map().cells(bin, beam).whole.bias());
      EXPECT_EQ(sum.map().cells(bin, beam).union_region.pixels, bin == 2 && beam == 0 ? 2 : 0);
    }
  }

  ResidualCollector of_other_axes;
  of_other_axes.Add(other_axes, other_axes, Mask(5, 3), Mask(5, 3));
  of_other_axes.Add(real, real, none, none);
  sum += of_other_axes;
  EXPECT_EQ(sum.frames(), 2) << "those of other axes are left out";
  EXPECT_EQ(sum.frames_left_out(), 3);
  sum += ResidualCollector();
  EXPECT_EQ(sum.frames(), 2);
  ResidualCollector empty;
  empty += of_other_axes;
  EXPECT_EQ(empty.frames(), 1);
  EXPECT_EQ(empty.frames_left_out(), 1);
  EXPECT_EQ(empty.axes().range_bins, 5);
  EXPECT_TRUE(ResidualCollector().ByBeam().classes.empty());
}

TEST(ResidualsTest, PixelsWithoutMeasurementCountNowhere) {
  const PolarImage real = ImageOf(2, 3, 50.0F), simulated = ImageOf(2, 3, 60.0F);
  const Mask all(2, 3, 1), valid = MaskOf({"#..", "###"});
  ResidualCollector residuals;
  residuals.Add(real, simulated, all, all, &valid);
  EXPECT_EQ(residuals.ByRange().classes[0].sums.whole.pixels, 1);
  EXPECT_EQ(residuals.ByBeam().classes[1].sums.union_region.pixels, 1);
}

TEST(ResidualsTest, PixelsGoIntoTheClassesOfTheCaller) {
  ResidualTable table{.by = "material", .unit = {}, .classes = {}};
  table.classes.push_back({.name = "sand, wet", .from = std::nullopt});
  table.classes.push_back({.name = "steel", .from = std::nullopt});
  const PolarImage real = ImageOf(2, 2, 50.0F);
  PolarImage simulated = real;
  simulated.value(1, 1) = 90.0F;
  const auto class_of = [](int bin, int beam) { return bin == 0 ? 0 : beam == 0 ? -1 : 1; };
  ResidualCollector::AddTo(table, class_of, real, simulated, Mask(2, 2, 1), Mask(2, 2));
  EXPECT_EQ(table.classes[0].sums.whole.pixels, 2);
  EXPECT_EQ(table.classes[1].sums.union_region.pixels, 1);
  EXPECT_NEAR(*table.classes[1].sums.whole.bias(), 0.4, 1e-7);

  const std::string csv = ResidualsCsv({table});
  EXPECT_THAT(csv, HasSubstr("material,\"sand, wet\",,,,whole,2,0,0,0\n"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
}

}  // namespace
}  // namespace sonarcal::metrics
