#include "sim/physics/beam_and_pulse.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::sim {
namespace {

// Bins of 0.1 m, three beams.
SonarModel Sonar() {
  SonarModel sonar;
  sonar.axes = {
      .range_min_m = 1.0, .range_max_m = 5.0, .range_bins = 40, .beam_azimuth_rad = {-0.2, 0.0, 0.2}};
  sonar.azimuth_beam_width_deg = 2.0;
  sonar.elevation_beam_width_deg = 14.0;
  return sonar;
}

ParameterSet Parameters(AzimuthPattern pattern) {
  ParameterSet parameters;
  parameters.beam.azimuth_pattern = pattern;
  parameters.beam.azimuth_taper = 1.0;
  return parameters;
}

std::vector<double> Columns() {
  std::vector<double> columns;
  for (int i = -700; i <= 700; ++i) columns.push_back(1e-3 * i);
  return columns;
}

// 2^-(2 x / width)^2.
double Gaussian(double x, double width) {
  return std::exp2(-4.0 * x * x / (width * width));
}

TEST(BeamAndPulseTest, WidthsAreTheSonarsUnlessGiven) {
  const SonarModel sonar = Sonar();
  ParameterSet parameters = Parameters(AzimuthPattern::kGaussian);
  parameters.beam.elevation_width_deg = 0.0;
  parameters.beam.azimuth_width_deg = 0.0;
  parameters.pulse.length_m = 0.0;
  const ParameterSet complete = WithResponse(sonar, parameters);
  EXPECT_EQ(complete.beam.azimuth_width_deg, 2.0);
  EXPECT_EQ(complete.beam.elevation_width_deg, 14.0);
  EXPECT_NEAR(complete.pulse.length_m, 0.1, 1e-15);
  parameters.beam.azimuth_width_deg = 3.0;
  parameters.beam.elevation_width_deg = 20.0;
  parameters.pulse.length_m = 0.25;
  const ParameterSet given = WithResponse(sonar, parameters);
  EXPECT_EQ(given.beam.azimuth_width_deg, 3.0);
  EXPECT_EQ(given.beam.elevation_width_deg, 20.0);
  EXPECT_EQ(given.pulse.length_m, 0.25);
}

TEST(BeamAndPulseTest, WidthsMayBeBelowOneDegree) {
  SonarModel sonar = Sonar();
  ParameterSet parameters = Parameters(AzimuthPattern::kGaussian);
  parameters.beam.azimuth_width_deg = 0.5;
  EXPECT_EQ(WithResponse(sonar, parameters).beam.azimuth_width_deg, 0.5);
  sonar.azimuth_beam_width_deg = 0.6;
  sonar.elevation_beam_width_deg = 0.7;
  parameters.beam.azimuth_width_deg = 0.0;
  EXPECT_EQ(WithResponse(sonar, parameters).beam.azimuth_width_deg, 0.6);
  EXPECT_EQ(WithResponse(sonar, parameters).beam.elevation_width_deg, 0.7);
  parameters.beam.elevation_width_deg = 0.8;
  EXPECT_EQ(WithResponse(sonar, parameters).beam.elevation_width_deg, 0.8);
}

TEST(BeamAndPulseTest, AnUnknownWidthIsRefusedUnlessThereIsATable) {
  SonarModel sonar = Sonar();
  sonar.azimuth_beam_width_deg = 0.0;
  EXPECT_THROW(WithResponse(sonar, Parameters(AzimuthPattern::kGaussian)), DataError);
  EXPECT_NO_THROW(WithResponse(sonar, Parameters(AzimuthPattern::kTable)));
}

// A line array hears 102 degrees as 78 degrees.
TEST(BeamAndPulseTest, AnApertureHasNoBeamsBehindIt) {
  SonarModel sonar = Sonar();
  sonar.axes.beam_azimuth_rad = {RadFromDeg(-102.0), 0.0, RadFromDeg(102.0)};
  ParameterSet parameters;
  parameters.beam.azimuth_pattern = AzimuthPattern::kAperture;
  EXPECT_THROW(AzimuthShapeOf(sonar, parameters), DataError);
  parameters.beam.azimuth_pattern = AzimuthPattern::kGaussian;
  EXPECT_NO_THROW(AzimuthShapeOf(sonar, parameters));
}

TEST(BeamAndPulseTest, TapersAndTablesOutOfBoundsAreRefused) {
  const SonarModel sonar = Sonar();
  ParameterSet parameters = Parameters(AzimuthPattern::kAperture);
  for (const double taper : {0.0, 1.0}) {
    parameters.beam.azimuth_taper = taper;
    EXPECT_NO_THROW(AzimuthShapeOf(sonar, parameters));
  }
  for (const double taper : {-0.01, 1.01}) {
    parameters.beam.azimuth_taper = taper;
    EXPECT_THROW(AzimuthShapeOf(sonar, parameters), DataError);
  }
  parameters = Parameters(AzimuthPattern::kTable);
  for (const int size : {1, 2, 4, 6}) {
    parameters.beam.azimuth_table_db.assign(size, 0.0);
    EXPECT_THROW(AzimuthShapeOf(sonar, parameters), DataError) << size;
  }
  parameters.beam.azimuth_table_db = {-20.0, 0.0, -20.0};
  const AzimuthShape<double> shape = AzimuthShapeOf(sonar, parameters);
  EXPECT_NEAR(shape.beam_spacing_rad, 0.2, 1e-15);
}

// 4 per bin and 4 per pulse, 64 at most.
TEST(BeamAndPulseTest, FineRowsResolveThePulse) {
  const SonarModel sonar = Sonar();
  ParameterSet parameters;
  const struct {
    double length_m;
    int steps;
  } cases[] = {{0.5, 4}, {0.1, 4}, {0.05, 8}, {0.03, 14}, {0.0125, 32}, {0.00625, 64}, {0.001, 64}};
  for (const auto& c : cases) {
    parameters.pulse.length_m = c.length_m;
    EXPECT_EQ(RangeStepsFor(sonar, parameters), c.steps) << c.length_m << " m";
  }
}

TEST(BeamAndPulseTest, SensitivityIsAFactorOnPower) {
  const SonarModel sonar = Sonar();
  BeamParameters beam;
  EXPECT_EQ(BeamSensitivity(sonar, beam), (std::vector<double>{1.0, 1.0, 1.0}));
  beam.sensitivity_db = {0.0, 10.0, -20.0};
  const std::vector<double> power = BeamSensitivity(sonar, beam);
  ASSERT_EQ(power.size(), 3U);
  EXPECT_NEAR(power[0], 1.0, 1e-12);
  EXPECT_NEAR(power[1], 10.0, 1e-12);
  EXPECT_NEAR(power[2], 0.01, 1e-12);
  beam.sensitivity_db = {0.0, 1.0};
  EXPECT_THROW(BeamSensitivity(sonar, beam), DataError);
}

// Weights of power, field and slope, in every column of the window. The slope of 2^-(2 x / w)^2 is
// -8 ln 2 x / w^2 times its value; the central difference over 2e-4 w errs by 1e-7 of the largest slope.
TEST(BeamAndPulseTest, PulseWindowIsTheGaussianAroundTheMiddleOfTheBin) {
  const SonarModel sonar = Sonar();
  ParameterSet parameters;
  for (const double length_m : {0.1, 0.23}) {
    parameters.pulse.length_m = length_m;
    for (const int steps : {4, 7}) {
      const ResponseWindow power = PulseWindow(sonar, parameters, steps, ResponseOf::kPower);
      const ResponseWindow field = PulseWindow(sonar, parameters, steps, ResponseOf::kField);
      const ResponseWindow slope = PulseWindow(sonar, parameters, steps, ResponseOf::kPowerSlope);
      ASSERT_EQ(field.weight.size(), power.weight.size());
      ASSERT_EQ(slope.weight.size(), power.weight.size());
      double sum = 0.0;
      for (std::size_t i = 0; i < power.weight.size(); ++i) {
        const double x = (power.first + static_cast<int>(i) + 0.5) * 0.1 / steps - 0.05;
        const double expected = Gaussian(x, length_m);
        EXPECT_NEAR(power.weight[i], expected, 1e-12);
        EXPECT_NEAR(field.weight[i], std::sqrt(expected), 1e-12);
        EXPECT_NEAR(slope.weight[i], -8.0 * std::numbers::ln2 * x / (length_m * length_m) * expected,
                    1e-6 / length_m);
        sum += power.weight[i] * 0.1 / steps;
      }
      EXPECT_NEAR(sum, length_m * std::sqrt(kPi / (4.0 * std::numbers::ln2)), 1e-9);
      // Cut 3 lengths away, or up to two bins further.
      const double first_m = (power.first + 0.5) * 0.1 / steps - 0.05;
      const double last_m = first_m + (static_cast<double>(power.weight.size()) - 1.0) * 0.1 / steps;
      EXPECT_LT(first_m, -3.0 * length_m);
      EXPECT_GT(last_m, 3.0 * length_m);
      EXPECT_GT(first_m, -3.0 * length_m - 0.2);
      EXPECT_LT(last_m, 3.0 * length_m + 0.2);
    }
  }
}

TEST(BeamAndPulseTest, BeamsThatReceiveFromTooManyColumnsAreRefused) {
  SonarModel sonar = Sonar();
  const auto row = [](int count) {  // within 1 degree
    std::vector<double> azimuth_rad(count);
    for (int i = 0; i < count; ++i) azimuth_rad[i] = RadFromDeg(1.0 * i / count - 0.5);
    return azimuth_rad;
  };
  sonar.axes.beam_azimuth_rad = row(10'001);
  const ParameterSet parameters = Parameters(AzimuthPattern::kGaussian);
  EXPECT_THAT([&] { AzimuthWindows(sonar, parameters, row(10'000), ResponseOf::kPower); },
              ::testing::ThrowsMessage<DataError>(
                  ::testing::HasSubstr("10001 beams receive from 10000 of 10000 columns of rays each")));
  sonar.axes.beam_azimuth_rad.resize(100);
  EXPECT_EQ(AzimuthWindows(sonar, parameters, row(10'000), ResponseOf::kPower).size(), 100U);
}

TEST(BeamAndPulseTest, AzimuthWindowsAreTheGaussianOfEachBeam) {
  const SonarModel sonar = Sonar();
  ParameterSet parameters = Parameters(AzimuthPattern::kGaussian);
  parameters.beam.sensitivity_db = {0.0, 10.0, -20.0};
  const double sensitivity[] = {1.0, 10.0, 0.01};
  const std::vector<double> columns = Columns();
  const double width = RadFromDeg(2.0);
  const auto power = AzimuthWindows(sonar, parameters, columns, ResponseOf::kPower);
  const auto field = AzimuthWindows(sonar, parameters, columns, ResponseOf::kField);
  const auto slope = AzimuthWindows(sonar, parameters, columns, ResponseOf::kPowerSlope);
  ASSERT_EQ(power.size(), 3U);
  for (int beam = 0; beam < 3; ++beam) {
    const ResponseWindow& window = power[beam];
    ASSERT_EQ(field[beam].first, window.first);
    ASSERT_EQ(slope[beam].weight.size(), window.weight.size());
    for (std::size_t i = 0; i < window.weight.size(); ++i) {
      const double x = columns[window.first + i] - sonar.axes.beam_azimuth_rad[beam];
      const double expected = Gaussian(x, width);
      EXPECT_NEAR(window.weight[i], sensitivity[beam] * expected, 1e-12);
      EXPECT_NEAR(field[beam].weight[i], std::sqrt(sensitivity[beam] * expected), 1e-12);
      EXPECT_NEAR(slope[beam].weight[i] / sensitivity[beam],
                  -8.0 * std::numbers::ln2 * x / (width * width) * expected, 1e-6 / width);
    }
    // -108 dB lies at 0.5 width sqrt(10.8 / log10(2)).
    const double reach = 0.5 * width * std::sqrt(10.8 / std::log10(2.0));
    EXPECT_NEAR(columns[window.first], sonar.axes.beam_azimuth_rad[beam] - reach, 1e-3);
    EXPECT_NEAR(columns[window.first + window.weight.size() - 1], sonar.axes.beam_azimuth_rad[beam] + reach,
                1e-3);
  }
}

TEST(BeamAndPulseTest, AzimuthWindowsOfAnApertureAreItsPattern) {
  const SonarModel sonar = Sonar();
  ParameterSet parameters = Parameters(AzimuthPattern::kAperture);
  parameters.beam.sensitivity_db = {0.0, 6.0, -3.0};
  const std::vector<double> columns = Columns();
  const AzimuthShape<double> shape = AzimuthShapeOf(sonar, parameters);
  const AzimuthResponse<double> response(shape);
  const auto power = AzimuthWindows(sonar, parameters, columns, ResponseOf::kPower);
  const auto field = AzimuthWindows(sonar, parameters, columns, ResponseOf::kField);
  const auto slope = AzimuthWindows(sonar, parameters, columns, ResponseOf::kPowerSlope);
  for (int beam = 0; beam < 3; ++beam) {
    const double centre = sonar.axes.beam_azimuth_rad[beam];
    const double factor = std::pow(10.0, parameters.beam.sensitivity_db[beam] / 10.0);
    const auto [lowest, highest] = AzimuthReachRad(response, centre, -60.0);
    ASSERT_EQ(power[beam].weight.size(), field[beam].weight.size());
    ASSERT_EQ(power[beam].weight.size(), slope[beam].weight.size());
    for (std::size_t i = 0; i < power[beam].weight.size(); ++i) {
      const double azimuth = columns[power[beam].first + i];
      EXPECT_GE(azimuth, lowest);
      EXPECT_LE(azimuth, highest);
      EXPECT_NEAR(power[beam].weight[i], factor * AzimuthPower(shape, azimuth, centre), 1e-12);
      EXPECT_NEAR(field[beam].weight[i], std::sqrt(factor) * response.Field(azimuth, centre), 1e-12);
      const double difference =
          (response.Power(azimuth + 1e-5, centre) - response.Power(azimuth - 1e-5, centre)) / 2e-5;
      EXPECT_NEAR(slope[beam].weight[i] / factor, difference, 1e-3);
    }
    EXPECT_LT(columns[power[beam].first] - lowest, 1e-3);
    EXPECT_LT(highest - columns[power[beam].first + power[beam].weight.size() - 1], 1e-3);
  }
}

// Level is linear over beams of 0.2 rad: the slope of 10^(level / 10) is ln 10 / 10 dB/rad times the value.
TEST(BeamAndPulseTest, AzimuthWindowsOfATableReachToItsLastValue) {
  const SonarModel sonar = Sonar();
  ParameterSet parameters = Parameters(AzimuthPattern::kTable);
  parameters.beam.azimuth_table_db = {-20.0, 0.0, -20.0};
  const std::vector<double> columns = Columns();
  const auto power = AzimuthWindows(sonar, parameters, columns, ResponseOf::kPower);
  const auto slope = AzimuthWindows(sonar, parameters, columns, ResponseOf::kPowerSlope);
  EXPECT_NEAR(columns[power[1].first], -0.2, 1e-9);
  ASSERT_EQ(power[1].weight.size(), 401U);
  EXPECT_NEAR(power[1].weight[300], 0.1, 1e-9);
  EXPECT_NEAR(slope[1].weight[300], -0.1 * std::numbers::ln10 / 10.0 * 20.0 / 0.2, 1e-6);
  EXPECT_NEAR(slope[1].weight[100], 0.1 * std::numbers::ln10 / 10.0 * 20.0 / 0.2, 1e-6);
}

}  // namespace
}  // namespace sonarcal::sim
