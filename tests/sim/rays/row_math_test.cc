// Rows in single precision against the formulas one at a time, in double.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/math/random.h"
#include "sim/acoustic/patch_shader.h"
#include "sim/physics/patch.h"
#include "sim/rays/ray_fan.h"
#include "sim/rays/row_math/directions.h"
#include "sim/rays/row_math/echoes.h"
#include "sim/rays/row_math/errors.h"
#include "sim/rays/row_math/sums.h"
#include "sim/scenes/sonar_presets.h"

namespace sonarcal::sim {
namespace {

TEST(RowMath, DirectionsAreThoseOfTheFan) {
  const SonarModel sonar = FindSonarPreset("p900-45").sonar;
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.7, -0.2, 0.5, 0.4).normalized();
  const Eigen::Matrix3f rotation = turn.toRotationMatrix().cast<float>();
  for (const RayFanOptions& options :
       {RayFanOptions{.sampling = Sampling::kFrustum, .cols = 300, .rows = 41},
        RayFanOptions{.sampling = Sampling::kBeams, .cols = 300, .rows = 41},
        RayFanOptions{.sampling = Sampling::kBeams, .cols = 300, .rows = 41, .stagger = true},
        RayFanOptions{.sampling = Sampling::kBeams, .cols = 300, .rows = 41, .stagger_rows = true},
        RayFanOptions{.sampling = Sampling::kBeams,
        .cols = 300,
        .rows = 11,
        .elevation_span_deg = 176.0,
        .stagger = true,
        .stagger_rows = true}}) {
    const RayFan fan(sonar, options);
    std::vector<float> x(fan.cols());
    std::vector<float> y(fan.cols());
    std::vector<float> z(fan.cols());
    for (int row = 0; row < fan.rows(); ++row) {
      fan.RowDirections(row, rotation, x.data(), y.data(), z.data());
      for (int col = 0; col < fan.cols(); ++col) {
        const Eigen::Vector3f expected = rotation * fan.Direction(row, col);
        ASSERT_LT((Eigen::Vector3f(x[col], y[col], z[col]) - expected).norm(), 5e-7F) << row << ' ' << col;
      }
    }
  }
}

TEST(RowMath, BearingsAllAround) {
  std::vector<float> x;
  std::vector<float> y;
  std::vector<float> z;
  for (int azimuth = -179; azimuth <= 179; ++azimuth) {
    for (const double elevation_deg : {-89.9, -45.0, -1e-4, 0.0, 3.0, 60.0}) {
      const double azimuth_rad = azimuth * std::numbers::pi / 180.0;
      const double elevation_rad = elevation_deg * std::numbers::pi / 180.0;
      x.push_back(static_cast<float>(5.0 * std::sin(azimuth_rad) * std::cos(elevation_rad)));
      y.push_back(static_cast<float>(5.0 * std::cos(azimuth_rad) * std::cos(elevation_rad)));
      z.push_back(static_cast<float>(5.0 * std::sin(elevation_rad)));
    }
  }
  std::vector<float> azimuth_rad(x.size());
  std::vector<float> elevation_rad(x.size());
  row_math::Bearings(x.data(), y.data(), z.data(), static_cast<int>(x.size()), azimuth_rad.data(),
                     elevation_rad.data());
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(azimuth_rad[i], std::atan2(double{x[i]}, double{y[i]}), 5e-7) << i;
    EXPECT_NEAR(elevation_rad[i], std::atan2(double{z[i]}, std::hypot(double{x[i]}, double{y[i]})), 3e-7)
        << i;
  }
}

TEST(RowMath, HalfTangentsOfEveryAngle) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const int count = 2000;
  std::vector<float> d[3];
  std::vector<float> n[3];
  std::vector<double> angle_rad;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d along =
        Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Eigen::Vector3d aside = along.unitOrthogonal();
    // Down to a thousandth of a degree.
    const double delta = i % 2 == 0 ? 1.7e-5 * (1 + i) : (i + 0.5) / count * 0.5 * std::numbers::pi;
    const double sign = i % 3 == 0 ? -1.0 : 1.0;
    const Eigen::Vector3d of =
        sign * std::exp(normal(random)) * (std::cos(delta) * along + std::sin(delta) * aside);
    for (int k = 0; k < 3; ++k) {
      d[k].push_back(static_cast<float>(along[k]));
      n[k].push_back(static_cast<float>(of[k]));
    }
    angle_rad.push_back(delta);
  }
  std::vector<float> found(count);
  row_math::HalfTangents(d[0].data(), d[1].data(), d[2].data(), n[0].data(), n[1].data(), n[2].data(), count,
                         found.data());
  // Five roundings of single precision.
  for (int i = 0; i < count; ++i) EXPECT_NEAR(2.0 * std::atan(found[i]), angle_rad[i], 6e-7) << angle_rad[i];
}

// To the last bit of single precision, and the same bits whether the rays meet one plane or several.
TEST(RowMath, PlaneRangesAreThoseOfTheEquation) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  constexpr int kCount = 500;
  constexpr int kPlanes = 3;
  std::vector<row_math::Plane> planes;
  for (int p = 0; p < kPlanes; ++p) {
    const Eigen::Vector3d of = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    planes.push_back({of.x(), of.y(), of.z(), 1e3 * normal(random)});
  }
  std::array<std::vector<float>, 3> origin_m;
  std::array<std::vector<float>, 3> direction;
  for (int i = 0; i < kCount; ++i) {
    for (int k = 0; k < 3; ++k) {
      origin_m[k].push_back(static_cast<float>(100.0 * normal(random)));
      direction[k].push_back(static_cast<float>(normal(random)));
    }
  }
  const std::vector<float> farthest_m(kCount, 5e3F);
  const row_math::Rays rays{.origin_m = {origin_m[0].data(), origin_m[1].data(), origin_m[2].data()},
                            .direction = {direction[0].data(), direction[1].data(), direction[2].data()},
                            .farthest_m = farthest_m.data()};
  std::vector<std::uint32_t> mixed(kCount);
  for (int i = 0; i < kCount; ++i) mixed[i] = static_cast<std::uint32_t>(i % kPlanes);
  std::vector<float> of_mixed(kCount);
  row_math::PlaneRanges(planes.data(), mixed.data(), rays, kCount, of_mixed.data());
  int between = 0;
  for (int p = 0; p < kPlanes; ++p) {
    const std::vector<std::uint32_t> one(kCount, static_cast<std::uint32_t>(p));
    std::vector<float> of_one(kCount);
    row_math::PlaneRanges(planes.data(), one.data(), rays, kCount, of_one.data());
    for (int i = 0; i < kCount; ++i) {
      if (mixed[i] == one[i]) {
        EXPECT_EQ(of_mixed[i], of_one[i]) << i;
      }
      long double away = planes[p][3];
      long double towards = 0.0L;
      for (int k = 0; k < 3; ++k) {
        away -= static_cast<long double>(planes[p][k]) * origin_m[k][i];
        towards += static_cast<long double>(planes[p][k]) * direction[k][i];
      }
      const auto expected_m = static_cast<double>(std::clamp(away / towards, 0.0L, 5000.0L));
      EXPECT_NEAR(of_one[i], expected_m, 6.1e-8 * expected_m) << i;
      between += expected_m > 0.0 && expected_m < 5e3 ? 1 : 0;
    }
  }
  EXPECT_GT(between, kCount / 2);
}

TEST(RowMath, EchoStepsFollowTheLevel) {
  std::vector<float> table;
  constexpr int kSteps = 1000;
  for (int i = 0; i <= kSteps + 1; ++i) table.push_back(std::sin(3.0F * static_cast<float>(i) / kSteps));
  const row_math::EchoLevel level{.offset = 2.0F, .per_log = 0.3F, .per_m = 0.01F, .limit = 2.5F};
  const int count = 501;
  std::vector<float> range_m(count);
  std::vector<float> half_tangent(count);
  std::vector<float> weight(count);
  for (int i = 0; i < count; ++i) {
    range_m[i] = 0.05F + 0.1F * static_cast<float>(i);
    half_tangent[i] = static_cast<float>(i) / (count - 1);
    weight[i] = i % 2 == 0 ? 1e6F : 2e5F;
  }
  std::vector<std::int32_t> steps(count);
  row_math::EchoSteps(level, {table.data(), kSteps}, range_m.data(), half_tangent.data(), weight.data(),
                      count, steps.data());
  for (int i = 0; i < count; ++i) {
    const double r = range_m[i];
    const double echo = std::min(2.5, 2.0 - 0.3 * std::log(r) - 0.01 * r + std::sin(3.0 * half_tangent[i]));
    EXPECT_NEAR(steps[i] / static_cast<double>(weight[i]), echo, 1e-5) << i;
  }
}

TEST(RowMath, NormalPairsAreThoseOfTheCounter) {
  const std::uint64_t seed = 0x123456789ABCDEFULL;
  constexpr int kCount = 100'003;
  constexpr std::uint32_t kFirst = 4'000'000'000U;
  std::vector<float> a(kCount);
  std::vector<float> b(kCount);
  std::vector<std::int32_t> offset(kCount);
  for (int i = 0; i < kCount; ++i) offset[i] = 2 * i + i % 3;
  row_math::NormalPairs(seed, kFirst, offset.data(), kCount, a.data(), b.data());
  double largest = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const auto [x, y] = NormalPairOfRay(seed, kFirst + static_cast<std::uint32_t>(offset[i]));
    largest = std::max({largest, std::abs(x - a[i]), std::abs(y - b[i])});
  }
  // Twenty-four bits of a turn, and of a number near 1 under the logarithm (radius 3e-4 is its resolution).
  EXPECT_LT(largest, 1e-3);
}

TEST(RowMath, ErrorsGrowByEitherLaw) {
  const std::vector<float> range_m = {0.5F, 3.0F, 12.0F};
  const std::vector<float> azimuth_rad = {-0.2F, 0.0F, 0.3F};
  const std::vector<float> a = {1.0F, -2.0F, 0.5F};
  const std::vector<float> b = {-1.0F, 0.5F, 2.0F};
  std::vector<float> r(3);
  std::vector<float> t(3);
  for (const bool root : {true, false}) {
    row_math::Disturb({.per_reference_square = 1.0F / 25.0F, .root = root}, 0.02F, 0.004F, range_m.data(),
                      azimuth_rad.data(), a.data(), b.data(), 3, r.data(), t.data());
    for (int i = 0; i < 3; ++i) {
      const double square = 1.0 + range_m[i] * range_m[i] / 25.0;
      const double g = root ? std::sqrt(square) : square;
      EXPECT_NEAR(r[i], range_m[i] + 0.02 * g * a[i], 1e-6);
      EXPECT_NEAR(t[i], azimuth_rad[i] + 0.004 * g * b[i], 1e-6);
    }
  }
}

TEST(RowMath, PixelsWithinTheImageAndTheOneForTheRest) {
  const std::vector<float> range_m = {0.0F, 1.0F, 2.0F, 3.0F, 2.0F, 2.0F, std::nextafter(3.0F, 0.0F)};
  const std::vector<std::int32_t> bin = {0, 0, 3, 4, -1, 3, 4};
  const std::vector<std::int32_t> beam = {0, 6, 2, 2, 2, -1, 0};
  std::vector<std::int32_t> pixel(range_m.size());
  row_math::Pixels(range_m.data(), 1.0F, 3.0F, bin.data(), beam.data(), 7, 999, 7, pixel.data());
  EXPECT_THAT(pixel, ::testing::ElementsAre(999, 6, 23, 999, 999, 999, 28));
}

TEST(RowMath, BinsWithinAndWithout) {
  const std::vector<float> value = {0.99F, 1.0F, 1.25F, 2.74F, 2.76F, 3.0F, -5.0F, 1e9F};
  std::vector<std::int32_t> bin(value.size());
  row_math::Bins(value.data(), 1.0F, 4.0F, 8, static_cast<int>(value.size()), bin.data());
  EXPECT_EQ(bin, (std::vector<std::int32_t>{-1, 0, 1, 6, 7, -1, -1, -1}));
}

constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
constexpr float kEnd = std::numeric_limits<float>::infinity();
constexpr float kLeast = std::numeric_limits<float>::denorm_min();
constexpr float kLargest = std::numeric_limits<float>::max();

// So many of one value that vectors are filled, and one more.
std::vector<float> Row(float value) {
  return std::vector<float>(17, value);
}

TEST(RowMath, ValuesOutsideTheImageHaveNoBin) {
  for (const float value : {kNoNumber, kEnd, -kEnd, kLargest, -kLargest, -kLeast, 8.0F}) {
    std::vector<std::int32_t> bin(17);
    row_math::Bins(Row(value).data(), 0.0F, 1.0F, 8, 17, bin.data());
    EXPECT_THAT(bin, ::testing::Each(-1)) << value;
  }
  for (const float value : {0.0F, kLeast, 0.5F}) {
    std::vector<std::int32_t> bin(17);
    row_math::Bins(Row(value).data(), 0.0F, 1.0F, 8, 17, bin.data());
    EXPECT_THAT(bin, ::testing::Each(0)) << value;
  }
}

TEST(RowMath, PixelsOfRangesThatAreNone) {
  const std::vector<std::int32_t> first(17, 0);
  for (const float range_m : {kNoNumber, kEnd, -kEnd, 0.0F, -1.0F, 3.0F, kLargest}) {
    std::vector<std::int32_t> pixel(17);
    row_math::Pixels(Row(range_m).data(), 0.0F, 3.0F, first.data(), first.data(), 7, 999, 17, pixel.data());
    EXPECT_THAT(pixel, ::testing::Each(999)) << range_m;
  }
}

TEST(RowMath, EchoStepsFromEveryRange) {
  const std::vector<float> table(12, 0.25F);
  for (const row_math::EchoLevel& level :
       {row_math::EchoLevel{.offset = 2.0F, .per_log = 0.3F, .per_m = 0.01F, .limit = 2.5F},
        row_math::EchoLevel{.offset = -1.0F, .per_log = 0.0F, .per_m = 0.0F, .limit = 2.5F}}) {
    for (const float range_m : {0.0F, kLeast, 1e-4F, 1.0F, 1e4F, kLargest, kEnd}) {
      for (const float half_tangent : {0.0F, kLeast, 0.5F, 1.0F}) {
        std::vector<std::int32_t> steps(17);
        row_math::EchoSteps(level, {table.data(), 10}, Row(range_m).data(), Row(half_tangent).data(),
                            Row(1e6F).data(), 17, steps.data());
        const double metres = std::clamp<double>(range_m, 1e-4, 1e6);
        const double echo = std::clamp(
            level.offset - level.per_log * std::log(metres) - level.per_m * metres + 0.25, -2.5, 2.5);
        for (const std::int32_t of : steps) EXPECT_NEAR(of, 1e6 * echo, 2.0) << range_m;
      }
    }
  }
}

TEST(RowMath, ElevationWeightsBeyondTheTable) {
  const std::vector<float> table = {1.0F, 2.0F, 4.0F, 4.0F};
  const auto weight = [&](float at, float elevation_offset) {
    std::vector<float> found(17);
    row_math::ElevationWeights({table.data(), 2}, at, 1.0F, Row(elevation_offset).data(), Row(3.0F).data(),
                               17, found.data());
    return found;
  };
  for (const float far : {-0.1F, -1e30F, -kEnd}) EXPECT_THAT(weight(0.0F, far), ::testing::Each(3.0F));
  for (const float far : {1.1F, 1e30F, kEnd}) EXPECT_THAT(weight(0.0F, far), ::testing::Each(12.0F));
  EXPECT_THAT(weight(0.25F, 0.0F), ::testing::Each(4.5F));
}

TEST(RowMath, CellWeightsOfEveryCell) {
  for (const double slope : {-1e6, -3.0, -0.01, 0.0, 0.2, 40.0}) {
    for (const double height : {1e-6, 0.05, 3.0, 30.0}) {
      for (const double limit : {0.0, 0.1, 2.0, 1e7}) {
        for (const double cosine : {0.0, 1e-20, 0.3, 1.0}) {
          const double top = std::clamp(slope + 0.5 * height, -limit, limit);
          const double bottom = std::clamp(slope - 0.5 * height, -limit, limit);
          const double expected = std::atan(top * cosine) - std::atan(bottom * cosine);
          std::vector<float> found(17);
          row_math::CellWeights(Row(static_cast<float>(cosine)).data(), Row(static_cast<float>(limit)).data(),
                                Row(1.0F).data(), static_cast<float>(slope), static_cast<float>(height), 17,
                                found.data());
          for (const float of : found)
            ASSERT_NEAR(of, expected, 1e-6 + 1e-3 * expected) << slope << ' ' << height << ' ' << limit;
        }
      }
    }
  }
}

TEST(RowMath, HalfTangentsOfNormalsOfEveryLength) {
  for (const float length : {0.0F, kLeast, 1e-15F, 1e-6F, 1.0F, 1e15F}) {
    std::vector<float> found(17, -1.0F);
    row_math::HalfTangents(Row(0.6F).data(), Row(0.0F).data(), Row(0.8F).data(), Row(0.0F).data(),
                           Row(0.0F).data(), Row(length).data(), 17, found.data());
    const double expected = std::tan(0.5 * std::acos(0.8));
    for (const float of : found) EXPECT_NEAR(of, length >= 1e-15F ? expected : 0.0, 1e-6) << length;
  }
}

TEST(RowMath, RangesOfRaysWithinAPlaneAreLimited) {
  const row_math::Plane plane = {0.0, 0.0, 1.0, 2.0};
  const std::vector<std::uint32_t> first(17, 0);
  const auto range_m = [&](float height_m, float upward) {
    std::vector<float> found(17);
    row_math::PlaneRanges(&plane, first.data(),
                          {.origin_m = {Row(0.0F).data(), Row(0.0F).data(), Row(height_m).data()},
                           .direction = {Row(1.0F).data(), Row(0.0F).data(), Row(upward).data()},
                           .farthest_m = Row(30.0F).data()},
                          17, found.data());
    return found;
  };
  EXPECT_THAT(range_m(2.0F, 0.0F), ::testing::Each(30.0F)) << "0 / 0";
  EXPECT_THAT(range_m(1.0F, 0.0F), ::testing::Each(30.0F)) << "parallel";
  EXPECT_THAT(range_m(1.0F, 1e-6F), ::testing::Each(30.0F)) << "beyond the limit";
  EXPECT_THAT(range_m(3.0F, 0.5F), ::testing::Each(0.0F)) << "behind";
  EXPECT_THAT(range_m(1.0F, 0.5F), ::testing::Each(2.0F));
}

TEST(RowMath, PatchPowersFarAndNear) {
  const std::vector<float> table(12, 2.0F);
  for (const float range_m : {1e-3F, 1.0F, 80.0F, 1e4F}) {
    std::vector<float> power(17);
    row_math::PatchPowers({table.data(), 10}, 0.05F, Row(range_m).data(), Row(1.0F).data(), Row(3.0F).data(),
                          17, power.data());
    const double r = range_m;
    const double expected = 6.0 * std::exp(-0.05 * r) / (r * r);
    for (const float of : power) EXPECT_NEAR(of, expected, 1e-5 * expected + 1e-37) << range_m;
  }
}

TEST(RowMath, WideSumsAreSumsForEachPlaceAndWeight) {
  std::vector<float> weight;
  std::vector<float> other;
  std::vector<float> values;
  for (int i = 0; i < 23; ++i) {
    weight.push_back(0.5F * static_cast<float>(i) - 3.0F);
    other.push_back(static_cast<float>(i * i));
    for (int k = 0; k < row_math::kWideSum; ++k) values.push_back(static_cast<float>(i * i - 7 * k));
  }
  const float* const weights[] = {weight.data(), other.data()};
  for (const int count : {0, 1, 4, 23}) {
    std::array<float, 2 * row_math::kWideSum> sums{};
    row_math::WideSums(weights, values.data(), count, sums.data());
    for (int w = 0; w < 2; ++w) {
      for (int k = 0; k < row_math::kWideSum; ++k) {
        double expected = 0.0;
        double size = 0.0;
        for (int i = 0; i < count; ++i) {
          const double term = double{weights[w][i]} * values[i * row_math::kWideSum + k];
          expected += term;
          size += std::abs(term);
        }
        EXPECT_NEAR(sums[w * row_math::kWideSum + k], expected, 1e-6 * size) << count << ' ' << w << ' ' << k;
      }
    }
  }
}

template <typename T>
void ExpectDotsToBeSums() {
  constexpr int kCount = 37;
  std::vector<T> weight(kCount);
  std::vector<T> other(kCount);
  std::vector<std::vector<T>> rows(row_math::kDots, std::vector<T>(kCount));
  for (int i = 0; i < kCount; ++i) {
    weight[i] = static_cast<T>(0.5 * i - 3.0);
    other[i] = static_cast<T>(1.0 / (1.0 + i));
    for (int k = 0; k < row_math::kDots; ++k) rows[k][i] = static_cast<T>(i * i - 7.0 * k);
  }
  const T* const weights[] = {weight.data(), other.data()};
  const T* const values[] = {rows[0].data(), rows[1].data(), rows[2].data(), rows[3].data()};
  for (const int count : {0, 1, 4, 8, 13, kCount}) {
    std::array<T, 2 * row_math::kDots> sums{};
    row_math::Dots(weights, values, count, sums.data());
    for (int w = 0; w < 2; ++w) {
      for (int k = 0; k < row_math::kDots; ++k) {
        double expected = 0.0;
        double size = 0.0;
        for (int i = 0; i < count; ++i) {
          const double term = double{weights[w][i]} * values[k][i];
          expected += term;
          size += std::abs(term);
        }
        EXPECT_NEAR(sums[w * row_math::kDots + k], expected, 4.0 * std::numeric_limits<T>::epsilon() * size)
            << count << ' ' << w << ' ' << k;
      }
    }
  }
}

TEST(RowMath, DotsAreSumsOfEachRowByEachWeight) {
  ExpectDotsToBeSums<double>();
  ExpectDotsToBeSums<float>();
}

TEST(RowMath, ALookupIsLinearBetweenTheValues) {
  const std::vector<float> values = {1.0F, 3.0F, 2.0F, 2.0F};
  const std::vector<float> at = {0.0F, 0.25F, 0.5F, 0.75F, 1.0F};
  std::vector<float> found(at.size());
  row_math::Lookup({values.data(), 2}, at.data(), static_cast<int>(at.size()), found.data());
  EXPECT_THAT(found, ::testing::ElementsAre(1.0F, 2.0F, 3.0F, 2.5F, 2.0F));
}

// The parts of row_math::EchoParts against those of FineRows::Spread, by their mean position and number.
TEST(RowMath, EchoPartsAreThoseOfFineRows) {
  const PolarAxes axes{1.0, 5.0, 40, {-0.1, 0.1}};
  const FineRows rows(axes, 4, 0.1);
  const row_math::RangeRows range_rows = RangeRowsOf(rows, axes);
  constexpr double kHeightRad = 0.02;
  for (const float range_m : {0.5F, 1.1F, 2.0F, 3.3F, 4.9F, 5.0F}) {
    for (const float half_tangent : {0.0F, 0.3F, 0.8F, 0.95F, 0.999F, 1.0F}) {
      float parts = 0.0F;
      float position = 0.0F;
      float step = 0.0F;
      row_math::EchoParts(range_rows, static_cast<float>(kHeightRad), static_cast<float>(LargestTangent()),
                          &range_m, &half_tangent, 1, &parts, &position, &step);
      if (range_m < 1.0F || range_m >= 5.0F) {
        EXPECT_EQ(parts, 0.0F);
        continue;
      }
      const double square = double{half_tangent} * half_tangent;
      const double depth_m =
          std::min(PatchDepthM(range_m, kHeightRad, (1.0 - square) / (1.0 + square)), 64.0 * rows.part_m);
      const double number = std::max(1.0, std::ceil(depth_m / rows.part_m));
      EXPECT_EQ(parts, number) << range_m << ' ' << half_tangent;
      EXPECT_NEAR(step, depth_m / number * rows.per_m, 1e-3) << range_m << ' ' << half_tangent;
      EXPECT_NEAR(position + 0.5 * (number - 1.0) * step, (range_m - rows.first_m) * rows.per_m, 1e-3)
          << range_m << ' ' << half_tangent;
    }
  }
}

TEST(RowMath, ASumWithAnEndlessTermIsEndless) {
  std::vector<double> a(37, 1.0);
  const std::vector<double> b(37, 2.0);
  const auto sum = [&] {
    const double* const weights[] = {a.data(), a.data()};
    const double* const values[row_math::kDots] = {b.data(), b.data(), b.data(), b.data()};
    double sums[2 * row_math::kDots];
    row_math::Dots(weights, values, 37, sums);
    return sums[0];
  };
  EXPECT_EQ(sum(), 74.0);
  a[20] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(sum(), std::numeric_limits<double>::infinity());
  a[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(sum()));
}

}  // namespace
}  // namespace sonarcal::sim
