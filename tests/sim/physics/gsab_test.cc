#include "sim/physics/gsab.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/types/parameter_table.h"

namespace sonarcal::sim {
namespace {

using GsabJet = ceres::Jet<double, 6>;

// The coefficients of the table below.
GsabParameters<double> Tabulated() {
  return {.a = std::pow(10.0, -0.8),
          .b_deg = 3.0,
          .c = std::pow(10.0, -2.4),
          .d = 2.0,
          .e = std::pow(10.0, -1.8),
          .f_deg = 12.0};
}

std::array<double, 6> Values(const GsabParameters<double>& p) {
  return {p.a, p.b_deg, p.c, p.d, p.e, p.f_deg};
}

template <typename T>
GsabParameters<T> FromValues(const std::array<T, 6>& v) {
  return {v[0], v[1], v[2], v[3], v[4], v[5]};
}

TEST(Gsab, LevelsEqualThePublishedTable) {
  const double table[][2] = {{0, -7.488},   {3, -9.376},   {5, -12.366},  {10, -18.048}, {20, -21.268},
                             {30, -24.339}, {45, -26.980}, {60, -30.020}, {75, -35.740}, {85, -45.194}};
  for (const auto& [incidence_deg, level_db] : table) {
    EXPECT_NEAR(GsabDb(Tabulated(), incidence_deg), level_db, 5e-4) << incidence_deg << " degrees";
  }
}

TEST(Gsab, WithoutFacetsTheCurveIsLambertsLaw) {
  const GsabParameters<double> lambert{
      .a = 0.0, .b_deg = 4.0, .c = std::pow(10.0, -2.7), .d = 2.0, .e = 0.0, .f_deg = 8.0};
  EXPECT_NEAR(GsabDb(lambert, 0.0), -27.0, 1e-9);
  EXPECT_NEAR(GsabDb(lambert, 60.0), -33.0206, 5e-5);
}

// Each half-width belongs to its own amplitude: at delta = B the specular term has fallen to exp(-1/2).
TEST(Gsab, WidthsAreStandardDeviations) {
  GsabParameters<double> p{.a = 1.0, .b_deg = 4.0, .c = 0.0, .d = 1.0, .e = 0.0, .f_deg = 8.0};
  EXPECT_NEAR(GsabPower(p, 4.0), std::exp(-0.5), 1e-15);
  p = {.a = 0.0, .b_deg = 4.0, .c = 0.0, .d = 1.0, .e = 1.0, .f_deg = 8.0};
  EXPECT_NEAR(GsabPower(p, 8.0), std::exp(-0.5), 1e-15);
}

// Between two directions: backscatter where they are one, the same either way round, a facet's peak midway.
TEST(Gsab, TwoDirectionsAreReciprocalAndBackscatterWhereTheyAgree) {
  const GsabParameters<double> p = Tabulated();
  for (const double incidence_deg : {0.0, 3.0, 20.0, 60.0, 89.0}) {
    EXPECT_NEAR(
        GsabBetweenPower(p, incidence_deg, incidence_deg, incidence_deg) / GsabPower(p, incidence_deg), 1.0,
        1e-12);
  }
  EXPECT_EQ(GsabBetweenPower(p, 20.0, 70.0, 25.0), GsabBetweenPower(p, 70.0, 20.0, 25.0));
  // Out at 40 degrees to one side, back at 40 to the other: the facet lies flat, and D = 2 is Lambert's law.
  EXPECT_NEAR(GsabBetweenPower(p, 40.0, 40.0, 0.0),
              p.a + p.e + p.c * std::pow(std::cos(RadFromDeg(40.0)), 2.0), 1e-12);
  const GsabParameters<double> lambert{.a = 0.0, .b_deg = 1.0, .c = 0.5, .d = 2.0, .e = 0.0, .f_deg = 1.0};
  EXPECT_NEAR(GsabBetweenPower(lambert, 60.0, 0.0, 30.0), 0.25, 1e-12);
  EXPECT_TRUE(std::isfinite(GsabBetweenPower(p, 90.0 + 1e-5, 40.0, 70.0)));
}

TEST(Gsab, StaysFiniteAtGrazing) {
  const GsabParameters<double> paper;  // Table 4
  EXPECT_DOUBLE_EQ(GsabDb(paper, 90.0), 10.0 * std::log10(kGsabFloor));
  // A hair beyond 90 degrees, by rounding: the cosine is clamped.
  EXPECT_TRUE(std::isfinite(GsabDb(paper, 90.0 + 1e-5)));
  EXPECT_NEAR(GsabDb(paper, 89.0), 10.0 * std::log10(100.0 * std::cos(RadFromDeg(89.0))), 1e-9);
}

// Central differences of step h = 1e-4 p err by h^2 f'''/6, at most 1e-8/6 p^3 f''' with p^3 f''' below 1e3
// dB for these curves, and by rounding, 1e-16 x 100 dB / 1e-4: 2e-6 in p df/dp.
TEST(Gsab, DerivativesEqualCentralDifferences) {
  constexpr std::array kNames = {"A", "B_deg", "C", "D", "E", "F_deg"};
  GsabParameters<double> wide = Tabulated();
  wide.f_deg = 40.0;  // keeps a level at 90 degrees
  for (const GsabParameters<double>& p : {GsabParameters<double>{}, Tabulated(), wide}) {
    for (const double incidence_deg : {0.0, 0.25, 3.0, 10.0, 30.0, 60.0, 85.0, 89.75, 90.0}) {
      const std::array<double, 6> at = Values(p);
      std::array<GsabJet, 6> jets;
      for (int i = 0; i < 6; ++i) jets[i] = GsabJet(at[i], i);
      const GsabJet level = GsabDb(FromValues(jets), incidence_deg);
      EXPECT_DOUBLE_EQ(level.a, GsabDb(p, incidence_deg));
      for (int i = 0; i < 6; ++i) {
        SCOPED_TRACE(std::string(kNames[i]) + " at " + std::to_string(incidence_deg));
        const double h = 1e-4 * at[i];
        std::array<double, 6> plus = at;
        std::array<double, 6> minus = at;
        plus[i] += h;
        minus[i] -= h;
        const double difference =
            (GsabDb(FromValues(plus), incidence_deg) - GsabDb(FromValues(minus), incidence_deg)) / (2.0 * h);
        ASSERT_TRUE(std::isfinite(level.v[i]));
        EXPECT_NEAR(level.v[i] * at[i], difference * at[i], 2e-6);
      }
    }
  }
}

// Power is linear in A, C and E: what makes their common factor a gauge.
TEST(Gsab, CommonFactorIsALevel) {
  GsabParameters<double> p = Tabulated();
  p.a *= 2.0;
  p.c *= 2.0;
  p.e *= 2.0;
  for (const double incidence_deg : {0.0, 20.0, 70.0}) {
    EXPECT_NEAR(GsabDb(p, incidence_deg) - GsabDb(Tabulated(), incidence_deg), 3.0103, 5e-5);
  }
}

TEST(Gsab, DefaultsAreThoseOfTable4AndLieWithinTheLimitsOfAFit) {
  EXPECT_EQ(Values(GsabParameters<double>{}), (std::array<double, 6>{90, 4, 100, 1, 90, 8}));
  const GsabParameters<double> defaults;
  VisitParameters(defaults, [](const ParameterInfo& info, double value) {
    EXPECT_LT(info.paper_fit->lower, value) << info.key;
    EXPECT_GT(info.paper_fit->upper, value) << info.key;
  });
}

}  // namespace
}  // namespace sonarcal::sim
