#include "sim/rays/ray_fan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::sim {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

SonarModel SonarWithBeams(const std::vector<double>& azimuth_deg, double elevation_width_deg = 20.0) {
  SonarModel sonar{.name = "test sonar",
                   .frequency_hz = 900e3,
                   .axes = {0.5, 9.0, 100, {}},
                   .azimuth_beam_width_deg = 1.0,
                   .elevation_beam_width_deg = elevation_width_deg,
                   .sound_speed_m_per_s = 1466.0};
  for (const double azimuth : azimuth_deg) sonar.axes.beam_azimuth_rad.push_back(RadFromDeg(azimuth));
  return sonar;
}

SonarModel EvenSonar(int beams, double spacing_deg) {
  std::vector<double> azimuth_deg;
  for (int beam = 0; beam < beams; ++beam) azimuth_deg.push_back((beam - 0.5 * (beams - 1)) * spacing_deg);
  return SonarWithBeams(azimuth_deg);
}

SonarModel UnevenSonar() {
  return SonarWithBeams({-14.0, -11.0, -9.0, -5.0, -4.0, 0.5, 1.5, 6.0, 7.0, 13.0});
}

RayFanOptions Options(Sampling sampling, int cols, int rows) {
  return {.sampling = sampling, .cols = cols, .rows = rows, .elevation_span_deg = 0.0};
}

// A direction is rounded to float: its components err by 2^-25, its length by at most sqrt(3) of that.
constexpr double kFloatRounding = 0x1p-24;

class BothSamplings : public ::testing::TestWithParam<Sampling> {};

TEST_P(BothSamplings, DirectionsAreUnitAndMeetTheDefinitionsOfTheAngles) {
  const RayFan fan(UnevenSonar(), Options(GetParam(), 50, 41));
  for (int row = 0; row < fan.rows(); ++row) {
    for (int col = 0; col < fan.cols(); ++col) {
      const Eigen::Vector3d d = fan.Direction(row, col).cast<double>();
      ASSERT_NEAR(d.norm(), 1.0, kFloatRounding);
      ASSERT_NEAR(fan.AzimuthRad(col), std::atan2(d.x(), d.y()), 2.0 * kFloatRounding);
      ASSERT_NEAR(fan.ElevationRad(row, col), std::atan2(d.z(), std::hypot(d.x(), d.y())),
                  2.0 * kFloatRounding);
    }
  }
}

// A margin widens the fan to either side, evenly, and moves no beam.
TEST_P(BothSamplings, MarginReachesBeyondTheOuterBeams) {
  const RayFan bare(UnevenSonar(), Options(GetParam(), 50, 4));
  RayFanOptions options = Options(GetParam(), 50, 4);
  options.azimuth_margin_deg = 3.0;
  const RayFan fan(UnevenSonar(), options);
  EXPECT_EQ(fan.beam_edges_rad(), bare.beam_edges_rad());
  const auto width = [&](int col) { return fan.AzimuthRad(col + 1) - fan.AzimuthRad(col); };
  const double left = fan.AzimuthRad(0) - 0.5 * width(0);
  const double right = fan.AzimuthRad(fan.cols() - 1) + 0.5 * width(fan.cols() - 2);
  // kBeams: whole columns, so up to one more; kFrustum: columns are even in the tangent.
  const double more = GetParam() == Sampling::kBeams ? std::max(width(0), width(fan.cols() - 2)) : 1e-3;
  EXPECT_NEAR(left, fan.beam_edges_rad().front() - RadFromDeg(3.0) - 0.5 * more, 0.5 * more + 1e-9);
  EXPECT_NEAR(right, fan.beam_edges_rad().back() + RadFromDeg(3.0) + 0.5 * more, 0.5 * more + 1e-3);
  for (int col = 1; col < fan.cols(); ++col) EXPECT_GT(fan.AzimuthRad(col), fan.AzimuthRad(col - 1));
  EXPECT_EQ(fan.BeamOfColumn(0), 0);
  EXPECT_EQ(fan.BeamOfColumn(fan.cols() - 1), 9);
  options.azimuth_margin_deg = -1.0;
  EXPECT_THAT([&] { options.Check(); }, ThrowsMessage<DataError>(HasSubstr("azimuth margin -1")));
}

// The solid angles of the rays are those of the cells that DirectionWithin spans.
TEST_P(BothSamplings, CellsMeetAndHaveTheirSolidAngle) {
  const RayFan fan(UnevenSonar(), Options(GetParam(), 50, 41));
  for (int row = 0; row + 1 < fan.rows(); row += 7) {
    for (int col = 0; col + 1 < fan.cols(); col += 7) {
      const auto at = [&](double u, double v) { return fan.DirectionWithin(row, col, u, v); };
      EXPECT_LT((at(0.0, 0.0) - fan.Direction(row, col).cast<double>()).norm(), 2.0 * kFloatRounding);
      EXPECT_LT((at(0.0, -0.5) - fan.DirectionWithin(row + 1, col, 0.0, 0.5)).norm(), 1e-12) << "row below";
      const Eigen::Vector3d across = at(0.5, 0.0) - at(-0.5, 0.0);
      const Eigen::Vector3d up = at(0.0, 0.5) - at(0.0, -0.5);
      EXPECT_NEAR(across.cross(up).norm() / fan.SolidAngleSr(row, col), 1.0, 1e-4);
      EXPECT_GT(across.x(), 0.0);
      EXPECT_GT(up.z(), 0.0);
    }
  }
}

TEST_P(BothSamplings, ColumnsRunFromLeftToRightAndRowsFromTheTop) {
  const RayFan fan(UnevenSonar(), Options(GetParam(), 50, 41));
  EXPECT_EQ(fan.size(), fan.rows() * fan.cols());
  for (int col = 1; col < fan.cols(); ++col) ASSERT_GT(fan.AzimuthRad(col), fan.AzimuthRad(col - 1));
  for (int row = 1; row < fan.rows(); ++row)
    ASSERT_LT(fan.ElevationRad(row, 0), fan.ElevationRad(row - 1, 0));
  EXPECT_LT(fan.Direction(0, 0).x(), 0.0F);
  EXPECT_GT(fan.Direction(0, 0).z(), 0.0F);
  EXPECT_GT(fan.Direction(0, 0).y(), 0.0F);
}

// A beam's interval runs midway to its neighbours; the outer two are symmetrical about their centres.
TEST_P(BothSamplings, ColumnsBelongToTheBeamWhoseIntervalHoldsThem) {
  const SonarModel sonar = UnevenSonar();
  const std::vector<double>& centres = sonar.axes.beam_azimuth_rad;
  const RayFan fan(sonar, Options(GetParam(), 333, 7));
  std::vector<int> rays(centres.size(), 0);
  for (int col = 0; col < fan.cols(); ++col) {
    std::size_t nearest = 0;
    for (std::size_t beam = 1; beam < centres.size(); ++beam) {
      if (std::abs(fan.AzimuthRad(col) - centres[beam]) < std::abs(fan.AzimuthRad(col) - centres[nearest])) {
        nearest = beam;
      }
    }
    EXPECT_EQ(fan.BeamOfColumn(col), static_cast<int>(nearest)) << "column " << col;
    rays[nearest] += fan.rows();
  }
  EXPECT_EQ(fan.rays_per_beam(), rays);
  EXPECT_EQ(std::accumulate(rays.begin(), rays.end(), 0), fan.size());
}

INSTANTIATE_TEST_SUITE_P(Sampling, BothSamplings, ::testing::Values(Sampling::kFrustum, Sampling::kBeams),
                         [](const auto& tested) {
                           return tested.param == Sampling::kFrustum ? "Frustum" : "Beams";
                         });

double TotalSolidAngle(const RayFan& fan) {
  double sum = 0.0;
  for (int row = 0; row < fan.rows(); ++row) {
    for (int col = 0; col < fan.cols(); ++col) sum += fan.SolidAngleSr(row, col);
  }
  return sum;
}

// The paper's Eq. 5 with its depth camera: f from the field of view, c at the centre, pixel centres at
// half-integers; X right, Y forward (depth), Z up.
TEST(Frustum, IsThePapersPinhole) {
  const RayFan fan(EvenSonar(60, 0.75), Options(Sampling::kFrustum, 30, 20));
  const double fx = 15.0 / std::tan(RadFromDeg(22.5));
  const double fy = 10.0 / std::tan(RadFromDeg(10.0));
  for (int row = 0; row < 20; ++row) {
    for (int col = 0; col < 30; ++col) {
      const Eigen::Vector3d point((col + 0.5 - 15.0) / fx, 1.0, -(row + 0.5 - 10.0) / fy);
      EXPECT_LT((fan.Direction(row, col).cast<double>() - point.normalized()).norm(), 2.0 * kFloatRounding);
    }
  }
}

// Solid angle of the rectangle [0, x] x [0, y] on the plane at unit distance.
double CornerSolidAngle(double x, double y) {
  return std::atan(x * y / std::sqrt(1.0 + x * x + y * y));
}

// The midpoint rule on (1 + x^2 + y^2)^(-3/2), whose second derivatives are at most 3: an error of at most
// (hx^2 + hy^2) / 24 x 3 x area.
TEST(Frustum, SolidAnglesAddUpToThePyramid) {
  for (const SonarModel& sonar : {EvenSonar(128, 0.5), UnevenSonar()}) {
    const std::vector<double> edges = sonar.axes.BeamEdgesRad();
    const double left = std::tan(edges.front());
    const double right = std::tan(edges.back());
    const double top = std::tan(RadFromDeg(10.0));
    const double closed_form = 2.0 * (CornerSolidAngle(right, top) - CornerSolidAngle(left, top));
    const RayFan fan(sonar, Options(Sampling::kFrustum, 200, 120));
    const double hx = (right - left) / 200;
    const double hy = 2.0 * top / 120;
    const double tolerance = (hx * hx + hy * hy) / 8.0 * (right - left) * 2.0 * top;
    EXPECT_NEAR(TotalSolidAngle(fan), closed_form, tolerance);
    EXPECT_LT(tolerance, 5e-5 * closed_form);  // a cubed cosine forgotten shows as 10 %
  }
}

TEST(Beams, SolidAnglesAddUpToTheBand) {
  const SonarModel sonar = UnevenSonar();
  const std::vector<double> edges = sonar.axes.BeamEdgesRad();
  const double band = 2.0 * std::sin(RadFromDeg(10.0));
  const RayFan fan(sonar, Options(Sampling::kBeams, 40, 30));
  EXPECT_NEAR(TotalSolidAngle(fan), (edges.back() - edges.front()) * band, 1e-12);
  // And beam by beam.
  for (int beam = 0; beam < 10; ++beam) {
    double sum = 0.0;
    for (int col = 0; col < fan.cols(); ++col) {
      if (fan.BeamOfColumn(col) != beam) continue;
      for (int row = 0; row < fan.rows(); ++row) sum += fan.SolidAngleSr(row, col);
    }
    EXPECT_NEAR(sum, (edges[beam + 1] - edges[beam]) * band, 1e-12) << "beam " << beam;
  }
}

TEST(Beams, EveryBeamGetsTheSameWholeColumns) {
  const RayFan fan(UnevenSonar(), Options(Sampling::kBeams, 41, 6));
  EXPECT_EQ(fan.cols(), 50);  // 41 over 10 beams, rounded up
  EXPECT_THAT(fan.rays_per_beam(), ::testing::Each(30));
}

TEST(Beams, ElevationsAreEvenOverTheSpan) {
  RayFanOptions options = Options(Sampling::kBeams, 10, 4);
  options.elevation_span_deg = 32.0;  // wins over the sonar's 20
  const RayFan fan(UnevenSonar(), options);
  const double expected_deg[] = {12.0, 4.0, -4.0, -12.0};
  for (int row = 0; row < 4; ++row)
    EXPECT_NEAR(DegFromRad(fan.ElevationRad(row, 3)), expected_deg[row], 1e-12);
}

TEST(Beams, CrowdedRowsCoverTheSameSpan) {
  RayFanOptions options = Options(Sampling::kBeams, 40, 200);
  const double even_sr = TotalSolidAngle(RayFan(UnevenSonar(), options));
  options.row_crowding = 5.0;
  const RayFan fan(UnevenSonar(), options);
  EXPECT_NEAR(TotalSolidAngle(fan), even_sr, 1e-12);
  const double even_deg = 20.0 / 200;
  const auto height_deg = [&](int row) {
    return DegFromRad(fan.ElevationRad(row, 0) - fan.ElevationRad(row + 1, 0));
  };
  EXPECT_NEAR(height_deg(99), even_deg / 5.0, 1e-4);
  // The slope of u / 5 + 4 u^3 / 5 where the first two rows meet.
  EXPECT_NEAR(height_deg(0), even_deg * (0.2 + 2.4 * 0.99 * 0.99), 1e-4);
  options.row_crowding = 0.5;
  EXPECT_THAT([&] { options.Check(); }, ThrowsMessage<DataError>(HasSubstr("row crowding 0.5")));
}

// --- Staggered rays

// Each ray stays in its column and at its elevation; down the rows all parts of the column are met alike.
TEST(Beams, StaggeredRaysSpreadOverTheirColumns) {
  RayFanOptions options = Options(Sampling::kBeams, 20, 233);
  const RayFan alike(UnevenSonar(), options);
  EXPECT_FALSE(alike.staggered());
  options.stagger = true;
  const RayFan fan(UnevenSonar(), options);
  EXPECT_TRUE(fan.staggered());
  EXPECT_EQ(fan.rays_per_beam(), alike.rays_per_beam());
  std::vector<float> azimuth_rad(fan.cols());
  std::vector<int> tenths(10, 0);
  for (int row = 0; row < fan.rows(); ++row) {
    fan.RowAzimuths(row, azimuth_rad.data());
    for (int col = 0; col < fan.cols(); ++col) {
      const Eigen::Vector3d d = fan.Direction(row, col).cast<double>();
      ASSERT_NEAR(fan.AzimuthRad(row, col), std::atan2(d.x(), d.y()), 2.0 * kFloatRounding);
      ASSERT_NEAR(azimuth_rad[col], fan.AzimuthRad(row, col), kFloatRounding);
      ASSERT_EQ(fan.ElevationRad(row, col), alike.ElevationRad(row, col));
      ASSERT_EQ(fan.AzimuthRad(col), alike.AzimuthRad(col));
      const auto above = std::upper_bound(fan.beam_edges_rad().begin(), fan.beam_edges_rad().end(),
                                          fan.AzimuthRad(row, col));
      ASSERT_EQ(above - fan.beam_edges_rad().begin() - 1, fan.BeamOfColumn(col));
    }
    // Beam 1 has two columns.
    const double width = 0.5 * (fan.beam_edges_rad()[2] - fan.beam_edges_rad()[1]);
    ++tenths[static_cast<int>(10.0 * (fan.AzimuthRad(row, 2) - fan.beam_edges_rad()[1]) / width)];
  }
  EXPECT_THAT(tenths, ::testing::Each(::testing::AllOf(::testing::Ge(22), ::testing::Le(25))));
  options.sampling = Sampling::kFrustum;
  EXPECT_THAT([&] { RayFan(UnevenSonar(), options); }, ThrowsMessage<DataError>(HasSubstr("staggered")));
}

// Each ray stays in its row and at its azimuth; along the columns all parts of the row are met alike, and a
// ray's solid angle is that of a cell about it.
TEST(Beams, StaggeredRowsSpreadOverTheirHeight) {
  RayFanOptions options = Options(Sampling::kBeams, 230, 13);
  options.row_crowding = 3.0;
  const RayFan alike(UnevenSonar(), options);
  options.stagger_rows = true;
  const RayFan fan(UnevenSonar(), options);
  EXPECT_FALSE(fan.staggered());
  std::vector<int> tenths(10, 0);
  for (int row = 0; row < fan.rows(); ++row) {
    for (int col = 0; col < fan.cols(); ++col) {
      const Eigen::Vector3d d = fan.Direction(row, col).cast<double>();
      ASSERT_NEAR(fan.ElevationRad(row, col), std::asin(d.z()), 2.0 * kFloatRounding);
      ASSERT_EQ(fan.AzimuthRad(row, col), alike.AzimuthRad(row, col));
      const auto edge_rad = [&](double v) { return std::asin(alike.DirectionWithin(row, col, 0.0, v).z()); };
      const double height = edge_rad(0.5) - edge_rad(-0.5);
      const double part = (fan.ElevationRad(row, col) - edge_rad(-0.5)) / height;
      ASSERT_GE(part, 0.0);
      ASSERT_LE(part, 1.0);
      ++tenths[std::min(9, static_cast<int>(10.0 * part))];
      const double of_row = alike.SolidAngleSr(row, col) / std::cos(alike.ElevationRad(row, col));
      ASSERT_NEAR(fan.SolidAngleSr(row, col) / (of_row * std::cos(fan.ElevationRad(row, col))), 1.0, 1e-12);
    }
  }
  const int even = fan.size() / 10;
  EXPECT_THAT(tenths,
              ::testing::Each(::testing::AllOf(::testing::Ge(even - 2 * 13), ::testing::Le(even + 2 * 13))));
  options.sampling = Sampling::kFrustum;
  EXPECT_THAT([&] { RayFan(UnevenSonar(), options); }, ThrowsMessage<DataError>(HasSubstr("staggered")));
}

// --- What a ray counts

std::vector<std::vector<float>> WeightsOf(const RayFan& fan) {
  std::vector<std::vector<float>> weights(fan.rows(), std::vector<float>(fan.cols()));
  for (int row = 0; row < fan.rows(); ++row) fan.RowWeights(row, weights[row].data());
  return weights;
}

TEST_P(BothSamplings, AllRaysWeighOneByDefault) {
  const RayFan fan(UnevenSonar(), Options(GetParam(), 50, 41));
  EXPECT_TRUE(fan.weighs_evenly());
  EXPECT_EQ(fan.largest_weight(), 1.0);
  for (const auto& row : WeightsOf(fan)) EXPECT_THAT(row, ::testing::Each(1.0F));
}

// 1 on average over each beam, whatever is cut off above and below, and never beyond the bound; by columns,
// rows and spans that are few, crowded, and wide.
TEST_P(BothSamplings, WeightsBySolidAngleAverageToOneInEachBeam) {
  for (const double span_deg : {0.0, 60.0, 165.0}) {
    for (const int rows : {1, 2, 41}) {
      RayFanOptions options = Options(GetParam(), 131, rows);
      options.elevation_span_deg = span_deg;
      options.weight = RayWeight::kSolidAngle;
      if (GetParam() == Sampling::kBeams) options.row_crowding = 4.0;
      const RayFan fan(UnevenSonar(), options);
      std::vector<double> sum(10, 0.0);
      for (const auto& row : WeightsOf(fan)) {
        for (int col = 0; col < fan.cols(); ++col) {
          EXPECT_GE(row[col], 0.0F);
          EXPECT_LE(row[col], fan.largest_weight() * (1.0 + 1e-6));
          sum[fan.BeamOfColumn(col)] += row[col];
        }
      }
      for (int beam = 0; beam < 10; ++beam)
        EXPECT_NEAR(sum[beam] / fan.rays_per_beam()[beam], 1.0, 2e-6) << rows << " rows, beam " << beam;
    }
  }
}

// Directions even in elevation along each column's azimuth, counted by the cell of the pinhole that they pass
// through: its share of them, times the column's width over the mean of its beam's. A count errs by one.
TEST(Frustum, WeighsACellByTheEvenAnglesThatPassThroughIt) {
  constexpr int kEach = 200'000;
  RayFanOptions options = Options(Sampling::kFrustum, 200, 25);
  options.elevation_span_deg = 50.0;
  options.weight = RayWeight::kSolidAngle;
  const SonarModel sonar = EvenSonar(10, 6.0);
  const RayFan fan(sonar, options);
  const auto weights = WeightsOf(fan);
  const double outer = std::tan(RadFromDeg(30.0));
  const auto edge_rad = [&](int col) { return std::atan(-outer + col * 2.0 * outer / 200); };
  const double top = std::tan(RadFromDeg(25.0)) / std::cos(RadFromDeg(30.0));
  for (const int col : {0, 3, 77, 100, 199}) {
    std::vector<int> count(25, 0);
    for (int i = 0; i < kEach; ++i) {
      const double elevation_rad = RadFromDeg(25.0) * (1.0 - 2.0 * (i + 0.5) / kEach);
      const double slope = std::tan(elevation_rad) / std::cos(fan.AzimuthRad(col));
      ++count[std::min(24, static_cast<int>((top - slope) / (2.0 * top) * 25))];
    }
    double width_rad = 0.0;
    int columns = 0;
    for (int other = 0; other < 200; ++other) {
      if (fan.BeamOfColumn(other) != fan.BeamOfColumn(col)) continue;
      width_rad += edge_rad(other + 1) - edge_rad(other);
      ++columns;
    }
    const double width = (edge_rad(col + 1) - edge_rad(col)) / (width_rad / columns);
    for (int row = 0; row < 25; ++row)
      EXPECT_NEAR(weights[row][col], width * 25.0 * count[row] / kEach, 3.0 * 25.0 / kEach) << row;
  }
}

// Even angles weigh alike by solid angle too; crowded rows by their height.
TEST(Beams, WeighBySolidAngleAsTheirRowsAreHigh) {
  RayFanOptions options = Options(Sampling::kBeams, 40, 200);
  options.weight = RayWeight::kSolidAngle;
  EXPECT_TRUE(RayFan(UnevenSonar(), options).weighs_evenly());
  options.row_crowding = 5.0;
  const RayFan fan(UnevenSonar(), options);
  EXPECT_FALSE(fan.weighs_evenly());
  const auto weights = WeightsOf(fan);
  EXPECT_NEAR(weights[99][7], 1.0 / 5.0, 1e-3);
  EXPECT_NEAR(weights[0][7], 0.2 + 2.4 * 0.995 * 0.995, 1e-3);
}

template <typename Make>
void ExpectRefused(const Make& make, const std::string& words) {
  EXPECT_THAT(make, ThrowsMessage<DataError>(HasSubstr(words)));
}

// The limit holds for the rays that are cast, which are more than those asked for.
TEST(RayFanRefusals, ColumnsOfTheMarginCountAmongTheRays) {
  const auto with = [](int cols, int rows, double margin_deg) {
    return [=] {
      RayFanOptions options = Options(Sampling::kBeams, cols, rows);
      options.azimuth_margin_deg = margin_deg;
      RayFan(EvenSonar(4, 2.0), options);
    };
  };
  // 10000 columns over 8 degrees, 75000 more on either side.
  ExpectRefused(with(10'000, 20'000, 60.0), "rays: 160000 x 20000 is more than 200 million");
  ExpectRefused(with(10'000, 1'251, 60.0), "rays: 160000 x 1251 is more than 200 million");
  // Four beams of 16667 columns each.
  ExpectRefused(with(66'665, 3'000, 0.0), "rays: 66668 x 3000 is more than 200 million");
}

TEST(RayFanRefusals, OptionsOutsideTheirLimitsAreRefusedByName) {
  const SonarModel sonar = UnevenSonar();
  const auto with = [&](int cols, int rows, double span_deg) {
    return [=] { RayFan(sonar, {Sampling::kFrustum, cols, rows, span_deg}); };
  };
  ExpectRefused(with(0, 10, 0.0), "0 columns");
  ExpectRefused(with(100'001, 10, 0.0), "100001 columns");
  ExpectRefused(with(10, -3, 0.0), "-3 rows");
  ExpectRefused(with(50'000, 50'000, 0.0), "200 million");
  ExpectRefused(with(10, 10, -1.0), "elevation span -1");
  ExpectRefused(with(10, 10, 181.0), "elevation span 181");
  ExpectRefused(with(10, 10, std::nan("")), "elevation span nan");
  ExpectRefused(with(10, 10, 175.0), "use the sampling 'beams'");

  ExpectRefused(
      [] {
        RayFan(SonarWithBeams({-86.0, 0.0, 80.0}), Options(Sampling::kFrustum, 9, 9));
      },
      "use the sampling 'beams'");
  EXPECT_NO_THROW(RayFan(SonarWithBeams({-86.0, 0.0, 80.0}), Options(Sampling::kBeams, 9, 9)));
  ExpectRefused(
      [] {
        RayFan(SonarWithBeams({-5.0, 5.0}, 0.0), Options(Sampling::kBeams, 9, 9));
      },
      "elevation beam width 0");
  ExpectRefused(
      [] {
        RayFan(SonarWithBeams({5.0, -5.0}), Options(Sampling::kBeams, 9, 9));
      },
      "left to right");
}

}  // namespace
}  // namespace sonarcal::sim
