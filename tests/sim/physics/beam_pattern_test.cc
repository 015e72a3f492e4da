#include "sim/physics/beam_pattern.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/types/units.h"

namespace sonarcal::sim {
namespace {

TEST(GaussianResponse, HalfPowerAtHalfWidth) {
  EXPECT_DOUBLE_EQ(GaussianResponse(0.0, 1.7), 1.0);
  EXPECT_NEAR(GaussianResponse(0.85, 1.7), 0.5, 1e-15);
  EXPECT_NEAR(GaussianResponse(-0.85, 1.7), 0.5, 1e-15);
  EXPECT_NEAR(GaussianResponse(1.7, 1.7), 1.0 / 16.0, 1e-15);
}

// The trapezoid rule over a Gaussian is exact to rounding at this step.
TEST(GaussianResponse, EquivalentWidthIsTheIntegral) {
  const double width = 1.7;
  const double step = width / 50.0;
  double integral = 0.0;
  for (int i = -500; i <= 500; ++i) integral += GaussianResponse(i * step, width) * step;
  EXPECT_NEAR(GaussianEquivalentWidth(width), integral, 1e-12);
  EXPECT_NEAR(GaussianEquivalentWidth(1.0), 1.0645, 5e-5);
}

// --- Azimuth

AzimuthShape<double> Aperture(double width_deg, double taper) {
  return {.pattern = AzimuthPattern::kAperture, .width_rad = RadFromDeg(width_deg), .taper = taper};
}

AzimuthShape<double> Table(const std::vector<double>& table_db, double spacing_rad) {
  return {.pattern = AzimuthPattern::kTable, .table_db = &table_db, .beam_spacing_rad = spacing_rad};
}

// The aperture's integral by Simpson's rule: its own definition.
double SlowApertureField(double v, double taper) {
  constexpr int kSteps = 4000;
  double sum = 0.0;
  double all = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double s = static_cast<double>(i) / kSteps - 0.5;
    const double cosine = std::cos(std::numbers::pi * s);
    const double weight = ((i == 0 || i == kSteps) ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0)) *
                          ((1.0 - taper) + taper * cosine * cosine);
    sum += weight * std::cos(2.0 * std::numbers::pi * v * s);
    all += weight;
  }
  return sum / all;
}

TEST(ApertureField, IsTheFourierIntegralOfItsShading) {
  for (const double taper : {0.0, 0.37, 1.0}) {
    for (const double v :
         {0.0, 1e-9, 0.05, 0.3, 0.72, 1.0 - 1e-7, 1.0, 1.0 + 1e-5, 1.09, 1.7, 2.0, 5.43, 20.2}) {
      EXPECT_NEAR(ApertureField(v, taper), SlowApertureField(v, taper), 1e-9)
          << "v " << v << ", taper " << taper;
      EXPECT_DOUBLE_EQ(ApertureField(-v, taper), ApertureField(v, taper));
    }
  }
}

TEST(ApertureField, SeriesAndQuotientMeet) {
  const double joint = std::sqrt(0.1) / std::numbers::pi;
  for (const double at : {joint, -joint}) {
    EXPECT_NEAR(Sinc(at * (1.0 - 1e-13)), Sinc(at * (1.0 + 1e-13)), 1e-13);
    EXPECT_NEAR(SincSlope(at * (1.0 - 1e-13)), SincSlope(at * (1.0 + 1e-13)), 1e-12);
  }
}

// Harris 1978, Table I: rectangle -13 dB, Hann -32 dB; to two digits by the extremum of the closed forms.
// Against the integral of the shading over the aperture, by the midpoint rule; and Harris' side lobe.
TEST(CosineApertureField, IsTheFourierIntegralOfItsShading) {
  for (const double v : {0.0, 0.2, 0.5, 0.500001, 0.8, 1.5, 2.7}) {
    constexpr int kSteps = 20000;
    double field = 0.0;
    double weight = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double s = (i + 0.5) / kSteps - 0.5;
      field += std::cos(std::numbers::pi * s) * std::cos(2.0 * std::numbers::pi * v * s);
      weight += std::cos(std::numbers::pi * s);
    }
    EXPECT_NEAR(CosineApertureField(v), field / weight, 1e-8) << v;
  }
  double highest = 0.0;
  for (double v = 1.5; v < 5.0; v += 1e-3) highest = std::max(highest, std::abs(CosineApertureField(v)));
  EXPECT_NEAR(20.0 * std::log10(highest), -23.0, 0.1);
}

TEST(ElevationResponse, IsAHalfAtHalfTheWidth) {
  for (const auto pattern :
       {ElevationPattern::kGaussian, ElevationPattern::kAperture, ElevationPattern::kCosine}) {
    const ElevationResponse response(pattern, RadFromDeg(20.0), 0.3);
    EXPECT_NEAR(response.Power(RadFromDeg(10.0)), 0.5, 1e-9);
    EXPECT_EQ(response.Power(0.0), 1.0);
  }
  // The aperture of the SYNTHETIC tank's truth: 2.4503 wavelengths for 20 degrees.
  const ElevationResponse response(ElevationPattern::kCosine, RadFromDeg(20.0), 0.0);
  const double one_way = CosineApertureField(2.4503 * std::sin(RadFromDeg(35.0)));
  EXPECT_NEAR(response.Power(RadFromDeg(35.0)), std::pow(one_way, 4), 1e-7);
}

TEST(AzimuthPower, HighestSideLobeHasTheTextbookLevel) {
  const struct {
    double taper;
    double level_db;
  } cases[] = {{0.0, -13.26}, {1.0, -31.47}};
  for (const auto& c : cases) {
    const AzimuthResponse<double> response(Aperture(1.0, c.taper));
    bool past_null = false;
    double highest = 0.0;
    double before = 1.0;
    for (double azimuth_deg = 0.0; azimuth_deg < 20.0; azimuth_deg += 0.001) {
      const double power = response.Power(RadFromDeg(azimuth_deg), 0.0);
      past_null = past_null || (power > before && azimuth_deg > 0.5);
      if (past_null) highest = std::max(highest, power);
      before = power;
    }
    EXPECT_NEAR(DbFromPower(highest), c.level_db, 0.005);
  }
}

TEST(AzimuthPower, HalfPowerWidthIsThatOfTheBeamAtBoreSight) {
  EXPECT_NEAR(ApertureHalfPower(0.0), 0.44295, 1e-5);
  EXPECT_NEAR(ApertureHalfPower(1.0), 0.72029, 1e-5);
  for (const double width_deg : {0.3, 1.0, 8.0}) {
    for (const double taper : {0.0, 0.5, 1.0}) {
      const AzimuthShape<double> shape = Aperture(width_deg, taper);
      EXPECT_DOUBLE_EQ(AzimuthPower(shape, 0.0, 0.0), 1.0);
      EXPECT_NEAR(AzimuthPower(shape, RadFromDeg(0.5 * width_deg), 0.0), 0.5, 1e-12);
      EXPECT_NEAR(AzimuthPower(shape, RadFromDeg(-0.5 * width_deg), 0.0), 0.5, 1e-12);
    }
  }
  const AzimuthShape<double> gaussian{.pattern = AzimuthPattern::kGaussian, .width_rad = 0.02};
  EXPECT_NEAR(AzimuthPower(gaussian, 0.31, 0.3), 0.5, 1e-12);
}

// A real array's beam 60 degrees off widens by 1 / cos 60 = 2, to first order in its width.
TEST(AzimuthPower, BeamsOffBoreSightAreWider) {
  const AzimuthShape<double> shape = Aperture(0.2, 1.0);
  const double beam = RadFromDeg(60.0);
  const double both =
      AzimuthPower(shape, beam + RadFromDeg(0.2), beam) * AzimuthPower(shape, beam - RadFromDeg(0.2), beam);
  EXPECT_NEAR(both, 0.25, 1e-4);
  EXPECT_NEAR(AzimuthEquivalentWidthRad(AzimuthResponse<double>(shape), beam) /
                  AzimuthEquivalentWidthRad(AzimuthResponse<double>(shape), 0.0),
              2.0, 1e-12);
}

TEST(AzimuthPower, FieldsAreItsRootsAndSideLobesAlternate) {
  const std::vector<double> table_db = {-30.0, -12.0, 0.0, -12.0, -30.0};
  const AzimuthShape<double> shapes[] = {
      Aperture(1.0, 0.0), Aperture(1.0, 1.0), Table(table_db, 0.01), {.width_rad = 0.02}};
  for (const AzimuthShape<double>& shape : shapes) {
    const AzimuthResponse<double> response(shape);
    for (double azimuth = -0.06; azimuth < 0.06; azimuth += 0.0007) {
      const double field = response.Field(azimuth, 0.003);
      EXPECT_NEAR(field * field, response.Power(azimuth, 0.003), 1e-14);
    }
  }
  // Uniform: nulls at v = 1, 2, ...; first side lobe negative, second positive.
  EXPECT_LT(ApertureField(1.43, 0.0), -0.2);
  EXPECT_GT(ApertureField(2.46, 0.0), 0.1);
}

TEST(AzimuthPower, DerivativesMatchCentralDifferences) {
  using Jet = ceres::Jet<double, 2>;
  constexpr double kStep = 1e-6;
  for (const double taper : {0.001, 0.4, 0.999}) {
    for (const double width_deg : {0.8, 3.0}) {
      const AzimuthResponse<double> centre(Aperture(width_deg, taper));
      // In v: on the axis, at the half-power point, at the removable singularities, in the side lobes.
      for (const double v : {0.0, 1e-8, 0.05, 0.7, 1.0, 1.0 + 1e-9, 1.3, 2.0, 4.4}) {
        const double azimuth = 0.2 + v / centre.aperture_wavelengths();
        AzimuthShape<Jet> shape{.pattern = AzimuthPattern::kAperture,
                                .width_rad = Jet(RadFromDeg(width_deg), 0),
                                .taper = Jet(taper, 1)};
        const Jet power = AzimuthPower(shape, azimuth, 0.2);
        const auto at = [&](double width_factor, double taper_step) {
          return AzimuthPower(Aperture(width_deg * width_factor, taper + taper_step), azimuth, 0.2);
        };
        const double by_width = (at(1.0 + kStep, 0.0) - at(1.0 - kStep, 0.0)) / (2.0 * kStep);
        const double by_taper = (at(1.0, kStep) - at(1.0, -kStep)) / (2.0 * kStep);
        EXPECT_NEAR(power.a, at(1.0, 0.0), 1e-14);
        EXPECT_NEAR(power.v[0] * RadFromDeg(width_deg), by_width, 1e-8) << "v " << v << ", taper " << taper;
        EXPECT_NEAR(power.v[1], by_taper, 1e-8) << "v " << v << ", taper " << taper;
      }
    }
  }
}

TEST(AzimuthPower, TablesAreLinearInDecibelsAndEnd) {
  const std::vector<double> table_db = {-40.0, -10.0, 0.0, -20.0, -30.0};
  const AzimuthShape<double> shape = Table(table_db, 0.01);
  const double beam = 0.123;
  EXPECT_NEAR(AzimuthPower(shape, beam, beam), 1.0, 1e-12);
  EXPECT_NEAR(AzimuthPower(shape, beam - 0.01, beam), 0.1, 1e-12);
  EXPECT_NEAR(AzimuthPower(shape, beam + 0.015, beam), std::pow(10.0, -2.5), 1e-12);
  EXPECT_NEAR(AzimuthPower(shape, beam - 0.02, beam), 1e-4, 1e-12) << "the last value itself";
  EXPECT_EQ(AzimuthPower(shape, beam + 0.0201, beam), 0.0);
  EXPECT_EQ(AzimuthPower(shape, beam - 0.0201, beam), 0.0);
}

// Beams that are not even: the table counts beams, whatever lies between them.
TEST(AzimuthPower, ATableIsIndexedByBeamEvenWhereBeamsAreUneven) {
  const std::vector<double> table_db = {-40.0, -10.0, 0.0, -20.0, -30.0};
  const std::vector<double> centres = {0.0, 0.01, 0.03, 0.035, 0.1};
  AzimuthShape<double> shape = Table(table_db, 0.02);
  shape.beam_azimuth_rad = &centres;
  EXPECT_NEAR(AzimuthPower(shape, 0.035, 0.01), 1e-3, 1e-12);
  EXPECT_NEAR(AzimuthPower(shape, 0.0, 0.01), 0.1, 1e-12);
  EXPECT_NEAR(AzimuthPower(shape, 0.02, 0.01), 0.1, 1e-12) << "half a beam to the right, -10 dB";
  EXPECT_EQ(FractionalBeam(centres, 0.1 + 0.13), 6.0);
  EXPECT_EQ(FractionalBeam(centres, -0.005), -0.5);
}

// By the trapezoid rule, over everything in front of the array.
TEST(AzimuthEquivalentWidth, WidthEqualsTheIntegralOfThePattern) {
  const std::vector<double> table_db = {-30.0, -12.0, 0.0, -12.0, -9.0};
  const AzimuthShape<double> shapes[] = {
      Aperture(1.0, 1.0), Aperture(1.0, 0.3), Table(table_db, 0.01), {.width_rad = 0.02}};
  for (const AzimuthShape<double>& shape : shapes) {
    const AzimuthResponse<double> response(shape);
    double integral = 0.0;
    constexpr double kStep = 1e-5;
    for (double azimuth = -1.5; azimuth < 1.5; azimuth += kStep)
      integral += response.Power(azimuth, 0.0) * kStep;
    // The sides of an aperture at taper 0.3 add 1 / cos(azimuth) where they are at -50 dB.
    EXPECT_NEAR(AzimuthEquivalentWidthRad(response, 0.0) / integral, 1.0, 1e-3);
  }
  // A Hann-shaded array of half-power width 1 degree.
  EXPECT_NEAR(DegFromRad(AzimuthEquivalentWidthRad(AzimuthResponse<double>(Aperture(1.0, 1.0)), 0.0)), 1.0413,
              1e-4);
}

TEST(AzimuthReach, NothingBeyondIsAboveTheLevelAndLittleIsLost) {
  const std::vector<double> table_db = {-30.0, -12.0, 0.0, -12.0, -30.0};
  const struct {
    AzimuthShape<double> shape;
    double lost;
  } cases[] = {{Aperture(1.0, 1.0), 1.5e-6},
               {Aperture(1.0, 0.3), 3e-4},
               {Table(table_db, 0.01), 1e-12},
               {{.width_rad = 0.02}, 1e-6}};
  for (const auto& c : cases) {
    const AzimuthResponse<double> response(c.shape);
    const double beam = 0.1;
    const auto [low, high] = AzimuthReachRad(response, beam, -60.0);
    EXPECT_LT(low, beam);
    EXPECT_GT(high, beam);
    double inside = 0.0;
    double outside = 0.0;
    for (double azimuth = -1.57; azimuth < 1.57; azimuth += 2e-5) {
      const double power = response.Power(azimuth, beam);
      (azimuth < low || azimuth > high ? outside : inside) += power;
      if (azimuth < low || azimuth > high) {
        ASSERT_LE(power, 1e-6 * (1.0 + 1e-9));
      }
    }
    EXPECT_LT(outside / inside, c.lost);
  }
  // Uniform shading: lobes fall as 1 / (pi v), -60 dB lies beyond what this array can see.
  const auto [low, high] = AzimuthReachRad(AzimuthResponse<double>(Aperture(1.0, 0.0)), 0.0, -60.0);
  EXPECT_NEAR(low, -0.5 * std::numbers::pi, 1e-6);
  EXPECT_NEAR(high, 0.5 * std::numbers::pi, 1e-6);
}

TEST(TransmitPattern, IsEvenThenACosineOfPressure) {
  BeamParameters beam;
  EXPECT_EQ(TransmitPattern(beam).Power(1.0), 1.0) << "not limited";
  beam.transmit_even_deg = 24.0;
  beam.transmit_end_deg = 45.0;
  const TransmitPattern sent(beam);
  EXPECT_EQ(sent.Power(RadFromDeg(23.9)), 1.0);
  EXPECT_NEAR(sent.Power(RadFromDeg(-34.5)), 0.5, 1e-12);  // half way: cos(45 degrees)
  EXPECT_NEAR(sent.Power(RadFromDeg(38.0)), 0.25, 1e-12);  // two thirds: cos(60 degrees)
  EXPECT_EQ(sent.Power(RadFromDeg(45.1)), 0.0);
  beam.transmit_end_deg = 24.0;  // a sharp edge
  EXPECT_EQ(TransmitPattern(beam).Power(RadFromDeg(24.1)), 0.0);
}

// Envelope of the side lobes at v: ((1 - t) + (t / 2) / (v^2 - 1)) / (pi v (1 - t / 2)). At the reach it is
// the level.
TEST(AzimuthReach, IsWhereTheEnvelopeOfTheSideLobesMeetsTheLevel) {
  for (const double t : {0.0, 0.4, 1.0}) {
    const AzimuthResponse<double> response(Aperture(8.0, t));
    const auto [low, high] = AzimuthReachRad(response, 0.1, -20.0);
    for (const double off : {std::sin(high) - std::sin(0.1), std::sin(0.1) - std::sin(low)}) {
      const double v = response.aperture_wavelengths() * off;
      const double envelope =
          ((1.0 - t) + 0.5 * t / (v * v - 1.0)) / (std::numbers::pi * v * (1.0 - 0.5 * t));
      EXPECT_NEAR(20.0 * std::log10(envelope), -20.0, 1e-6) << "taper " << t;
    }
  }
}

// Beams 0.01 .. 0.07 rad apart, a table of one beam to each side at 0 dB: an even response over two beams.
TEST(AzimuthReach, ATableReachesAsFarAsTheWidestBeams) {
  const std::vector<double> table_db = {0.0, 0.0, 0.0};
  const std::vector<double> centres = {0.0, 0.01, 0.03, 0.1, 0.11};
  AzimuthShape<double> shape = Table(table_db, 0.0275);
  shape.beam_azimuth_rad = &centres;
  const AzimuthResponse<double> response(shape);
  const auto [low, high] = AzimuthReachRad(response, 0.03, -60.0);
  EXPECT_NEAR(low, 0.03 - 0.07, 1e-8);
  EXPECT_NEAR(high, 0.03 + 0.07, 1e-8);
  EXPECT_NEAR(AzimuthEquivalentWidthRad(response, 0.02), 2.0 * 0.02, 1e-12);
  EXPECT_NEAR(AzimuthEquivalentWidthRad(response, 0.05), 2.0 * 0.07, 1e-12);
  EXPECT_NEAR(AzimuthEquivalentWidthRad(response, 0.005), 2.0 * 0.01, 1e-12);
  EXPECT_NEAR(AzimuthEquivalentWidthRad(response, 0.105), 2.0 * 0.01, 1e-12);
}

// A slope of 10 dB per beam integrates to (1 - 0.1) / ln 10 of a beam, an even step to its value.
TEST(AzimuthEquivalentWidth, StepsOfATableInClosedForm) {
  const std::vector<double> table_db = {-10.0, 0.0, 0.0, -10.0 * std::log10(2.0), -300.0};
  const double expected = 0.9 / std::numbers::ln10 + 1.0 + 0.5 / std::numbers::ln2 +
                          0.5 / (std::numbers::ln10 * (30.0 - std::log10(2.0)));
  EXPECT_NEAR(AzimuthEquivalentWidthRad(AzimuthResponse<double>(Table(table_db, 0.01)), 0.0), 0.01 * expected,
              1e-12);
}

TEST(ElevationResponse, IsEvenWithoutAWidth) {
  EXPECT_EQ(ElevationResponse(ElevationPattern::kGaussian, 0.0, 0.0).Power(0.5), 1.0);
}

// sinc(x) = 1 - (pi x)^2 / 6 + ...
TEST(ApertureField, SlopeOfTheSincFallsToZeroOnTheAxis) {
  EXPECT_EQ(SincSlope(0.0), 0.0);
  EXPECT_NEAR(SincSlope(1e-6), -kPi * kPi / 3.0 * 1e-6, 1e-15);
}

// cos(pi v) / (1 - 4 v^2) is 0 first at v = 1.5.
TEST(ElevationResponse, MainLobeEndsAtTheFirstNull) {
  const double width_rad = RadFromDeg(20.0);
  const double wavelengths = 0.4254963363382263 / std::sin(0.5 * width_rad);
  EXPECT_NEAR(MainLobeEndRad({ElevationPattern::kCosine, width_rad, 0.0}), std::asin(1.5 / wavelengths),
              1e-3);
  EXPECT_EQ(MainLobeEndRad({ElevationPattern::kGaussian, width_rad, 0.0}), 0.5 * kPi);
}

}  // namespace
}  // namespace sonarcal::sim
