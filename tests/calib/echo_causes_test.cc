// What a pixel's power comes from, against images of the acoustic model that have one cause each.
#include "sim/gathered/echo_causes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "sim/physics/beam_and_pulse.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

class EchoCausesTest : public ::testing::Test {
 protected:
  static ParameterSet Parameters() {
    ParameterSet parameters = testing::SmallTankAcousticTruth();
    parameters.receiver.noise_db = 100.0;
    parameters.pulse.length_m = 0.05;
    for (const char* name : {"wall", "board"}) parameters.materials[name] = parameters.materials["box"];
    parameters.mirrors["floor"].loss_db = 3.0;
    parameters.mirrors["wall"].loss_db = 5.0;
    const int beams = testing::SmallSonar().axes.beam_count();
    for (int beam = 0; beam < beams; ++beam)
      parameters.beam.sensitivity_db.push_back(0.1 * (beam % 20) - 1.5);
    return parameters;
  }

  static sim::SimulationOptions Options() {
    sim::SimulationOptions options = testing::SmallTankOptions();
    options.fan.elevation_span_deg = 140.0;  // side lobes of the elevation pattern have something to show
    return options;
  }

  // The whole expected power of some parameters, noise included.
  Grid<float> Expected(const Pose& pose, const ParameterSet& parameters) const {
    const sim::AcousticGeometry geometry{simulator_.sonar(), simulator_.absorption_db_per_m()};
    return sim::ExpectedPower(simulator_.Scatter(simulator_.TraceEchoes(pose), parameters,
                                                 simulator_.TraceGhosts(pose, parameters)),
                              geometry, parameters)
        .value;
  }

  static ParameterSet Without(bool mirrors, const std::string& only_material = {}) {
    ParameterSet parameters = Parameters();
    parameters.receiver.noise_db.reset();
    if (!mirrors) parameters.mirrors.clear();
    for (auto& [name, material] : parameters.materials) {
      if (only_material.empty() || name == only_material) continue;
      material.gsab.a = material.gsab.c = material.gsab.e = 0.0;
    }
    return parameters;
  }

  const sim::Simulator simulator_{testing::SmallTankWithWall(), testing::SmallSonar(), Options()};
};

TEST_F(EchoCausesTest, TogetherTheyAreTheExpectedPower) {
  for (const Pose& pose : testing::SmallTankPoses()) {
    const sim::EchoCauses causes = sim::CausesOf(simulator_, pose, Parameters());
    const Grid<float> expected = Expected(pose, Parameters());
    ASSERT_EQ(causes.causes.front().kind, sim::CauseKind::kNoise);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      double sum = 0.0;
      for (const sim::EchoCause& cause : causes.causes) sum += cause.power.values()[i];
      // Curves are joined by straight lines between nodes a quarter of a degree apart.
      EXPECT_NEAR(sum, expected.values()[i], 0.01 * expected.values()[i]) << i;
    }
  }
}

// Rendered one by one, the slow way: a material alone, a mirror's ghosts as what it adds. Where lobes matter
// this can't tell, and is not asked.
TEST_F(EchoCausesTest, TheLargestIsThatOfImagesRenderedOneByOne) {
  const sim::ElevationResponse elevation = sim::ElevationResponseOf(simulator_.sonar(), Parameters().beam);
  const double end_rad = sim::MainLobeEndRad(elevation);
  long compared = 0;
  long lobes = 0;
  long ghosts = 0;
  for (const Pose& pose : testing::SmallTankPoses()) {
    const sim::EchoCauses causes = sim::CausesOf(simulator_, pose, Parameters());
    std::map<std::string, Grid<float>> slow;
    const Grid<float> direct = Expected(pose, Without(false));
    for (const char* mirror : {"floor", "wall"}) {
      ParameterSet only = Without(true);
      std::erase_if(only.mirrors, [&](const auto& of) { return of.first != mirror; });
      Grid<float> added = Expected(pose, only);
      for (std::size_t i = 0; i < added.size(); ++i) added.values()[i] -= direct.values()[i];
      slow[std::string("ghost by ") + mirror] = std::move(added);
    }
    // By material, whatever the lobe.
    for (const std::string& material : simulator_.caster().material_names())
      slow[material] = Expected(pose, Without(false, material));
    Grid<float> noise(direct.rows(), direct.cols());
    const sim::AcousticGeometry geometry{simulator_.sonar(), simulator_.absorption_db_per_m()};
    const Grid<double> floor = sim::NoiseFloorPower(geometry, Parameters());
    std::copy(floor.values().begin(), floor.values().end(), noise.values().begin());
    slow["noise"] = std::move(noise);

    const Grid<int> largest = causes.Largest();
    for (std::size_t i = 0; i < direct.size(); ++i) {
      const sim::EchoCause& cause = causes.causes[largest.values()[i]];
      lobes +=
          cause.kind == sim::CauseKind::kAzimuthLobe || cause.kind == sim::CauseKind::kElevationLobe ? 1 : 0;
      if (cause.kind == sim::CauseKind::kAzimuthLobe || cause.kind == sim::CauseKind::kElevationLobe)
        continue;
      std::string best;
      double most = -1.0;
      double second = -1.0;
      for (const auto& [name, power] : slow) {
        const double value = power.values()[i];
        if (value > most) {
          second = most;
          most = value;
          best = name;
        } else {
          second = std::max(second, value);
        }
      }
      // A tie within the errors of nodes and single precision; or a material whose lobes make it the largest.
      if (most < 1.05 * second) continue;
      double of_lobes = 0.0;
      for (const sim::EchoCause& other : causes.causes) {
        if (other.kind == sim::CauseKind::kAzimuthLobe || other.kind == sim::CauseKind::kElevationLobe)
          of_lobes += other.power.values()[i];
      }
      if (of_lobes > 0.05 * most) continue;
      ++compared;
      ghosts += cause.kind == sim::CauseKind::kGhost ? 1 : 0;
      EXPECT_EQ(cause.name, best) << i;
    }
  }
  EXPECT_GT(compared, 15000);
  EXPECT_GT(ghosts, 300);
  EXPECT_GT(lobes, 10);
  EXPECT_GT(end_rad, 0.5 * 40.0 * kPi / 180.0) << "beyond half power";
}

// A single bright patch: what beams beside it hear by their side lobes comes from its direction.
TEST_F(EchoCausesTest, ASideLobeNamesTheBeamItComesFrom) {
  Scene post;
  const float half_m = 0.03F;
  post.vertices_m = {{-half_m, 2, 0}, {half_m, 2, 0}, {half_m, 2, 1}, {-half_m, 2, 1}};
  post.triangles = {{0, 1, 2}, {0, 2, 3}};
  post.triangle_material = {0, 0};
  post.material_names = {"post"};
  ParameterSet parameters = Parameters();
  parameters.mirrors.clear();
  parameters.materials["post"] = parameters.materials["box"];
  const sim::Simulator simulator(post, testing::SmallSonar(), testing::SmallTankOptions());
  const sim::EchoCauses causes =
      sim::CausesOf(simulator, {Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.5}}, parameters);
  const Grid<int> largest = causes.Largest();
  int lobes = 0;
  for (int bin = 0; bin < largest.rows(); ++bin) {
    for (int beam = 0; beam < largest.cols(); ++beam) {
      if (causes.causes[largest(bin, beam)].kind != sim::CauseKind::kAzimuthLobe) continue;
      ++lobes;
      EXPECT_NEAR(causes.lobe_of(bin, beam), 23.5, 2.0) << "the post stands ahead";
      EXPECT_GE(std::abs(beam - 23.5), 1.5) << "in the main lobe";
    }
  }
  EXPECT_GT(lobes, 4);
}

// With an even number of columns per beam, two of them share the peak of the response.
TEST_F(EchoCausesTest, PatternsWithoutSideLobesHaveNoneInAzimuth) {
  ParameterSet gaussian = Parameters();
  gaussian.mirrors.clear();
  gaussian.beam.azimuth_pattern = AzimuthPattern::kGaussian;
  ParameterSet table = gaussian;
  table.beam.azimuth_pattern = AzimuthPattern::kTable;
  table.beam.azimuth_table_db = {-30.0, -9.0, 0.0, -7.0, -30.0};
  for (const int columns_per_beam : {4, 5}) {
    sim::SimulationOptions options = Options();
    options.fan.cols = columns_per_beam * testing::SmallSonar().axes.beam_count();
    const sim::Simulator simulator(testing::SmallTankWithWall(), testing::SmallSonar(), options);
    for (const ParameterSet& parameters : {gaussian, table}) {
      const sim::EchoCauses causes = sim::CausesOf(simulator, testing::SmallTankPoses().front(), parameters);
      EXPECT_TRUE(causes.lobe_of.empty()) << columns_per_beam;
      for (const sim::EchoCause& cause : causes.causes)
        EXPECT_NE(cause.kind, sim::CauseKind::kAzimuthLobe) << columns_per_beam;
    }
  }
}

TEST(MainLobeEnd, IsTheFirstNullOfACosineAperture) {
  // cos(pi v) / (1 - 4 v^2) is first null at v = 3/2; half power two-way at 0.4254963.
  const double width_rad = 20.0 * kPi / 180.0;
  const sim::ElevationResponse response(ElevationPattern::kCosine, width_rad, 1.0);
  const double wavelengths = 0.4254963363382263 / std::sin(0.5 * width_rad);
  EXPECT_NEAR(sim::MainLobeEndRad(response), std::asin(1.5 / wavelengths), 2e-3);
  EXPECT_EQ(sim::MainLobeEndRad({ElevationPattern::kGaussian, width_rad, 1.0}), 0.5 * kPi);
}

}  // namespace
}  // namespace sonarcal::calib
