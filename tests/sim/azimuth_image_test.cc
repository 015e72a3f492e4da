// The azimuth responses as the acoustic image shows them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/acoustic/acoustic_image.h"
#include "sim/physics/beam_and_pulse.h"
#include "tests/sim/meshes.h"
#include "tests/sim/slow_paper_model.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

SonarModel WideSonar(int beams, double spacing_deg, double width_deg) {
  SonarModel sonar = MakeSonar(EvenAzimuthsDeg(beams, spacing_deg), 20.0, 2.0, 4.0, 40);
  sonar.azimuth_beam_width_deg = width_deg;
  return sonar;
}

ParameterSet WithPattern(AzimuthPattern pattern, double taper) {
  ParameterSet p;
  p.model = EchoModel::kAcoustic;
  p.beam.azimuth_pattern = pattern;
  p.beam.azimuth_taper = taper;
  p.pulse.length_m = 0.1;
  p.materials["default"].gsab = {.a = 0.16, .b_deg = 6.0, .c = 4e-3, .d = 2.0, .e = 0.016, .f_deg = 20.0};
  p.display = {.db_min = -200.0, .db_max = 400.0};
  return p;
}

// A point of unit power at one azimuth, in one fine row.
ScatterMap OneTarget(const SonarModel& sonar, double azimuth_rad, int row) {
  ScatterMap scatter;
  scatter.range_steps = 4;
  scatter.column_azimuth_rad = {azimuth_rad};
  scatter.power = Grid<double>(sonar.axes.range_bins * scatter.range_steps, 1);
  scatter.power(row, 0) = 1.0;
  return scatter;
}

// Sum of a point's image over pixels x their size = the responses' integrals. Per beam in the sine of
// azimuth, where an array's response has one shape and beams much denser than the pattern sum to the integral
// exactly, but for what lies beyond the fan or below the cut: 2 / (2 pi^2 v) of the energy at taper 0 beyond
// v on either side (v = 50 here), nothing to speak of at taper 1.
TEST(AzimuthImage, EnergyOfAPointIsThatOfTheResponses) {
  const SonarModel sonar = WideSonar(601, 0.2, 1.0);
  const struct {
    AzimuthPattern pattern;
    double taper;
    double equivalent_width;  // in the sine
    double lost;
  } cases[] = {
      {AzimuthPattern::kAperture, 1.0, 1.5 * std::sin(RadFromDeg(0.5)) / 0.720291, 1e-5},
      {AzimuthPattern::kAperture, 0.0, 1.0 * std::sin(RadFromDeg(0.5)) / 0.442946, 1.0 / (9.87 * 40.0)},
      {AzimuthPattern::kGaussian, 1.0, 1.064467 * RadFromDeg(1.0), 2e-4},  // beams are 1 / cos apart in sine
  };
  for (const auto& c : cases) {
    const ParameterSet parameters = WithPattern(c.pattern, c.taper);
    const Grid<float> image = ExpectedPower(OneTarget(sonar, 0.0, 82), {sonar, 0.0}, parameters).value;
    double sum = 0.0;
    for (int bin = 0; bin < 40; ++bin) {
      for (int beam = 0; beam < 601; ++beam) {
        sum +=
            double{image(bin, beam)} * 0.05 * RadFromDeg(0.2) * std::cos(sonar.axes.beam_azimuth_rad[beam]);
      }
    }
    const double expected = c.equivalent_width * 0.1 * std::sqrt(kPi / (4.0 * std::log(2.0)));
    EXPECT_LE(sum / expected, 1.0 + 1e-4);
    EXPECT_GE(sum / expected, 1.0 - c.lost - 1e-4);
  }
}

TEST(AzimuthImage, APointHasThePatternsSideLobes) {
  const SonarModel sonar = WideSonar(601, 0.05, 1.0);
  const struct {
    double taper;
    double level_db;
  } cases[] = {{0.0, -13.26}, {1.0, -31.47}};
  for (const auto& c : cases) {
    const ParameterSet parameters = WithPattern(AzimuthPattern::kAperture, c.taper);
    const Grid<float> image = ExpectedPower(OneTarget(sonar, 0.0, 82), {sonar, 0.0}, parameters).value;
    const auto row = image.row(20);
    int beam = 300;
    const double peak = row[beam];
    while (row[beam + 1] < row[beam]) ++beam;  // down the main lobe
    const double highest = *std::max_element(row.begin() + beam, row.end());
    EXPECT_NEAR(DbFromPower(highest / peak), c.level_db, 0.02);
    const AzimuthShape<double> shape = AzimuthShapeOf(sonar, parameters);
    for (int other = 0; other < 601; ++other) {
      const double expected = AzimuthPower(shape, 0.0, sonar.axes.beam_azimuth_rad[other]);
      EXPECT_NEAR(row[other] / peak, expected, expected > 1e-6 ? 1e-6 * expected + 1e-12 : 1.1e-6);
    }
  }
}

// A lens sonar's side lobes come at whole beams off the target: an arc at its range.
TEST(AzimuthImage, ATableMakesArcsAtTheTargetsRange) {
  std::vector<double> uneven;
  uneven.reserve(60);
  for (int beam = 0; beam < 60; ++beam)
    uneven.push_back(0.3 * (beam - 29.5) + 2e-5 * std::pow(beam - 29.5, 3));
  SonarModel sonar = MakeSonar(uneven, 20.0, 2.0, 4.0, 40);
  ParameterSet parameters = WithPattern(AzimuthPattern::kTable, 1.0);
  parameters.beam.azimuth_table_db.assign(33, -90.0);
  parameters.beam.azimuth_table_db[16] = 0.0;
  parameters.beam.azimuth_table_db[8] = parameters.beam.azimuth_table_db[24] = -22.0;
  parameters.beam.azimuth_table_db[0] = parameters.beam.azimuth_table_db[32] = -29.0;
  const Grid<float> image =
      ExpectedPower(OneTarget(sonar, sonar.axes.beam_azimuth_rad[20], 82), {sonar, 0.0}, parameters).value;
  for (int bin = 18; bin < 23; ++bin) {
    const double peak = image(bin, 20);
    EXPECT_NEAR(DbFromPower(image(bin, 12) / peak), -22.0, 1e-4);
    EXPECT_NEAR(DbFromPower(image(bin, 28) / peak), -22.0, 1e-4);
    EXPECT_NEAR(DbFromPower(image(bin, 4) / peak), -29.0, 1e-4);
    EXPECT_NEAR(DbFromPower(image(bin, 36) / peak), -29.0, 1e-4);
    EXPECT_NEAR(DbFromPower(image(bin, 24) / peak), -90.0, 1e-4);
    EXPECT_EQ(image(bin, 3), 0.0F);
    EXPECT_EQ(image(bin, 37), 0.0F);
  }
}

Scene FloorBelow() {
  Scene scene;
  AddQuad(scene, {-20, -4, 0}, {40, 0, 0}, {0, 20, 0}, "floor");
  return scene;
}

Grid<float> FloorImage(const SonarModel& sonar, const ParameterSet& parameters,
                       const RayFanOptions& options) {
  const RayFan fan(sonar, options);
  const EchoList echoes =
      Trace(RayCaster(FloorBelow()), fan, {Eigen::Quaterniond::Identity(), {0, 0, 0.5}}, sonar.axes);
  return ExpectedPower(MakeScatterMap(echoes, fan, {sonar, 0.3}, parameters), {sonar, 0.3}, parameters).value;
}

// With a margin that holds the pattern, a level floor looks the same to every beam but for its width; four
// times the rays change nothing.
TEST(AzimuthImage, LevelDependsOnTheCellAloneAndNotOnTheRays) {
  const SonarModel sonar = WideSonar(41, 1.0, 1.0);
  for (const double taper : {0.0, 1.0}) {
    const ParameterSet parameters = WithPattern(AzimuthPattern::kAperture, taper);
    const RayFanOptions few{.sampling = Sampling::kBeams,
                            .cols = 41 * 6,
                            .rows = 500,
                            .elevation_span_deg = 32.0,
                            .azimuth_margin_deg = taper > 0.5 ? 6.0 : 45.0};
    RayFanOptions many = few;
    many.cols *= 2;
    many.rows *= 2;
    const Grid<float> with_few = FloorImage(sonar, parameters, few);
    const Grid<float> with_many = FloorImage(sonar, parameters, many);
    const AzimuthResponse<double> response(AzimuthShapeOf(sonar, parameters));
    for (int bin = 8; bin < 34; ++bin) {
      for (int beam = 0; beam < 41; ++beam) {
        EXPECT_NEAR(DbFromPower(with_many(bin, beam) / with_few(bin, beam)), 0.0, 0.05);
        const double width = AzimuthEquivalentWidthRad(response, sonar.axes.beam_azimuth_rad[beam]) /
                             AzimuthEquivalentWidthRad(response, 0.0);
        // Uniform shading: of its sides 1 / (pi^2 v) lies beyond the margin, 0.3 % at v = 35.
        EXPECT_NEAR(DbFromPower(with_many(bin, beam) / with_many(bin, 20)), DbFromPower(width),
                    taper > 0.5 ? 0.005 : 0.03)
            << "bin " << bin << ", beam " << beam << ", taper " << taper;
      }
    }
    // Without a margin the outer beams see half of their main lobe.
    RayFanOptions bare = few;
    bare.azimuth_margin_deg = 0.0;
    const Grid<float> edge = FloorImage(sonar, parameters, bare);
    EXPECT_LT(DbFromPower(edge(20, 0) / with_few(20, 0)), -0.2);
  }
}

TEST(AzimuthImage, BadPatternsAreRefused) {
  const SonarModel sonar = WideSonar(11, 1.0, 1.0);
  ParameterSet parameters = WithPattern(AzimuthPattern::kAperture, 1.5);
  EXPECT_THROW(AzimuthShapeOf(sonar, parameters), DataError);
  parameters = WithPattern(AzimuthPattern::kTable, 1.0);
  EXPECT_THROW(AzimuthShapeOf(sonar, parameters), DataError);
  parameters.beam.azimuth_table_db = {-3.0, 0.0};
  EXPECT_THROW(AzimuthShapeOf(sonar, parameters), DataError);
}

}  // namespace
}  // namespace sonarcal::sim
