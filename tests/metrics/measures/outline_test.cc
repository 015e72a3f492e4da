#include "metrics/measures/outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using testing::MaskOf;
using testing::SmallAxes;

// Bins of 1 cm about 2 m, beams 1 / 200 rad apart: 1 cm there too.
PolarAxes Centimetres(int bins, int beams) {
  PolarAxes axes{2.0 - 0.005 * bins, 2.0 + 0.005 * bins, bins, {}};
  for (int beam = 0; beam < beams; ++beam)
    axes.beam_azimuth_rad.push_back(0.005 * (beam - 0.5 * (beams - 1)));
  return axes;
}

TEST(OutlineTest, EqualRegionsLieOnEachOther) {
  const Mask region = MaskOf({"......", ".####.", ".####.", ".####.", "......"});
  const OutlineDistance distance = MeasureOutlines(region, region, Centimetres(5, 6));
  EXPECT_EQ(distance.points, 2 * 10);  // 12 pixels, of which two lie inside
  EXPECT_EQ(distance.mean_m(), 0.0);
  EXPECT_EQ(distance.hausdorff_95_m(), 0.0);
}

TEST(OutlineTest, PixelsShiftedAlongRangeOrAzimuthLieAsFarApartAsTheyAreInMetres) {
  Mask real(41, 41), along_range(41, 41), along_azimuth(41, 41);
  real(10, 20) = along_range(17, 20) = 1;
  along_azimuth(10, 25) = 1;
  const PolarAxes axes = Centimetres(41, 41);
  EXPECT_NEAR(*MeasureOutlines(real, along_range, axes).mean_m(), 0.07, 1e-12);
  const double chord_m = 2.0 * axes.range_centre_m(10) * std::sin(0.5 * 5 * 0.005);
  EXPECT_NEAR(*MeasureOutlines(real, along_azimuth, axes).mean_m(), chord_m, 1e-12);
  EXPECT_NEAR(*MeasureOutlines(real, along_azimuth, axes).hausdorff_95_m(), chord_m, 1e-12);
}

// A row of 20 pixels against the same with one more pixel, 5 cm off its end: 20 points at 0 one way, 20 at 0
// and one at 5 cm the other. Of 21 the 95th percentile is the 20th.
TEST(OutlineTest, APercentileLeavesOutTheStrayPixelThatTheMeanCounts) {
  Mask real(30, 5), simulated(30, 5);
  for (int bin = 0; bin < 20; ++bin) real(bin, 2) = simulated(bin, 2) = 1;
  simulated(24, 2) = 1;
  const PolarAxes axes = Centimetres(30, 5);
  const OutlineDistance distance = MeasureOutlines(real, simulated, axes);
  EXPECT_NEAR(*distance.mean_m(), 0.05 / 41.0, 1e-12);
  EXPECT_NEAR(*distance.hausdorff_95_m(), 0.0, 1e-12);
  simulated(25, 2) = 1;  // two of 22: the 21st is the nearer of the strays
  EXPECT_NEAR(*MeasureOutlines(real, simulated, axes).hausdorff_95_m(), 0.05, 1e-12);
  EXPECT_EQ(MeasureOutlines(real, simulated, axes), MeasureOutlines(simulated, real, axes));
}

// Every pair of points.
TEST(OutlineTest, AgreesWithTheExhaustiveSearch) {
  std::mt19937_64 random(3);
  const PolarAxes axes = SmallAxes(25, 18);
  for (int round = 0; round < 10; ++round) {
    Mask masks[2] = {Mask(25, 18), Mask(25, 18)};
    for (Mask& mask : masks) {
      for (std::uint8_t& pixel : mask.values()) pixel = random() % (3 + round) == 0;
      mask(0, 0) = 1;
    }
    std::vector<std::pair<double, double>> points[2];
    for (int m = 0; m < 2; ++m) {
      for (int row = 0; row < 25; ++row) {
        for (int col = 0; col < 18; ++col) {
          if (!masks[m](row, col)) continue;
          const bool border = row == 0 || row == 24 || col == 0 || col == 17;
          if (!border && masks[m](row - 1, col) && masks[m](row + 1, col) && masks[m](row, col - 1) &&
              masks[m](row, col + 1))
            continue;
          const double range_m = axes.range_centre_m(row);
          points[m].emplace_back(range_m * std::cos(axes.beam_azimuth_rad[col]),
                                 range_m * std::sin(axes.beam_azimuth_rad[col]));
        }
      }
    }
    double sum = 0.0, hausdorff = 0.0;
    for (int m = 0; m < 2; ++m) {
      std::vector<double> distances;
      for (const auto& a : points[m]) {
        double nearest = 1e9;
        for (const auto& b : points[1 - m]) {
          nearest = std::min(nearest, std::hypot(a.first - b.first, a.second - b.second));
        }
        distances.push_back(nearest);
        sum += nearest;
      }
      std::sort(distances.begin(), distances.end());
      const auto rank = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(distances.size())));
      hausdorff = std::max(hausdorff, distances[rank - 1]);
    }
    const OutlineDistance distance = MeasureOutlines(masks[0], masks[1], axes);
    EXPECT_NEAR(distance.sum_m, sum, 1e-9);
    EXPECT_NEAR(*distance.hausdorff_95_m(), hausdorff, 1e-12);
  }
}

TEST(OutlineTest, AnEmptyRegionHasNoDistanceAndPoolingCountsOnlyTheOthers) {
  const Mask region = MaskOf({"#.", ".."});
  const PolarAxes axes = Centimetres(2, 2);
  const OutlineDistance nothing = MeasureOutlines(region, Mask(2, 2), axes);
  EXPECT_EQ(nothing.mean_m(), std::nullopt);
  EXPECT_EQ(nothing.hausdorff_95_m(), std::nullopt);
  EXPECT_EQ(MeasureOutlines(Mask(2, 2), Mask(2, 2), axes).mean_m(), std::nullopt);

  OutlineDistance pooled = MeasureOutlines(region, MaskOf({"..", "#."}), axes);
  EXPECT_NEAR(*pooled.hausdorff_95_m(), 0.01, 1e-12);
  OutlineDistance twice = pooled;
  twice += pooled;
  EXPECT_NEAR(*twice.mean_m(), 0.01, 1e-12);
  EXPECT_EQ(twice.frames, 2);
  pooled += nothing;
  EXPECT_NEAR(*pooled.hausdorff_95_m(), 0.01, 1e-12);
  pooled += MeasureOutlines(region, region, axes);
  EXPECT_NEAR(*pooled.mean_m(), 0.005, 1e-12);
  EXPECT_EQ(pooled.hausdorff_95_m(), std::nullopt);  // sums do not tell
}

}  // namespace
}  // namespace sonarcal::metrics
