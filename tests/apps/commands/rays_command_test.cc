#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "apps/workflow/rays/ray_errors.h"
#include "core/types/error.h"
#include "sim/scenes/scene_primitives.h"
#include "sim/scenes/scenes.h"
#include "sim/scenes/sonar_presets.h"
#include "tests/apps/tiny_world.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::commands {
namespace {

using ::testing::HasSubstr;
using testing::IsOneSentence;
using testing::Outcome;
using testing::Quoted;
using testing::ReadJsonFile;
using testing::RunSonarcal;
using testing::TinyWorld;

ParameterSet TankParameters() {
  ParameterSet parameters;
  parameters.display = {.db_min = 150.0, .db_max = 153.0};
  parameters.materials["default"];
  return parameters;
}

TEST(MeasureRayErrors, FallWithRaysAndVanishAtTheDenseImageItself) {
  const SonarModel& sonar = sim::FindSonarPreset("p900-45").sonar;
  const sim::RayCaster caster(sim::MakeMockupTank());
  sim::SimulationOptions simulation;
  workflow::RayErrorOptions options{
      .grids = {{256, 100}, {512, 200}, {1024, 400}}, .dense = {1024, 400}, .denser = 1.0};
  int images = 0;
  const workflow::RayErrors found = workflow::MeasureRayErrors(
      caster, sonar, TankParameters(), simulation, {sim::MockupTankPoses(3)[1]}, options, [&] { ++images; });
  const std::vector<workflow::RayError>& errors = found.counts;
  EXPECT_EQ(images, workflow::RayErrorImages(sonar, 1, options));
  ASSERT_EQ(errors.size(), 6U);
  for (const std::size_t first : {0U, 3U}) {
    EXPECT_GT(errors[first].p999_grey, errors[first + 1].p999_grey);
    EXPECT_GT(errors[first + 1].p999_grey, 1.0);
    EXPECT_GE(errors[first].max_grey, errors[first].p999_grey);
    // Stripes of one count and of twice as many both leave a fifth of the pixels wrong: no order there.
    EXPECT_LT(errors[first + 1].within_one, 1.0);
    EXPECT_LT(errors[first].within_one_lit, errors[first].within_one);
    EXPECT_NEAR(errors[first].denser, 16.0, 1e-9);
    EXPECT_NEAR(errors[first].p999_db, errors[first].p999_grey * 3.0 / 255.0, 1e-12);
    EXPECT_EQ(errors[first + 2].max_grey, 0.0);
    EXPECT_EQ(errors[first + 2].within_one, 1.0);
    const auto fewest = workflow::MinRays(errors, errors[first].sampling);
    ASSERT_TRUE(fewest.has_value());
    EXPECT_EQ(fewest->rays(), 1024 * 400);
  }
  options.grids.pop_back();
  EXPECT_FALSE(workflow::MinRays(workflow::MeasureRayErrors(caster, sonar, TankParameters(), simulation,
                                                            {sim::MockupTankPoses(3)[1]}, options)
                                     .counts,
                                 sim::Sampling::kFrustum)
                   .has_value());
}

// One plate across the view: its brightest echo, by the printed equations, is the one straight ahead.
TEST(DisplayUpToBrightest, EndsAtTheBrightestEcho) {
  const SonarModel& sonar = sim::FindSonarPreset("p900-45").sonar;
  Scene scene = sim::MakePatch({-20, 4, -20}, {40, 0, 0}, {0, 0, 40}, sim::kUndivided, "plate");
  const sim::RayCaster caster(scene);
  sim::SimulationOptions simulation;
  const double alpha_db_per_m =
      sim::AbsorptionDbPerM(simulation.absorption, sonar.frequency_hz, simulation.water);
  const double expected_db = 200.0 - 40.0 * std::log10(4.0) - 8.0 * alpha_db_per_m + 10.0 * std::log10(280.0);
  const auto display =
      workflow::DisplayUpToBrightest(caster, sonar, TankParameters(), simulation, {Pose{}}, {512, 401}, 60.0);
  EXPECT_NEAR(display.db_max, expected_db, 0.01);  // no ray is quite level
  EXPECT_LE(display.db_max, expected_db);
  EXPECT_DOUBLE_EQ(display.db_min, display.db_max - 60.0);
  const Pose away{Eigen::Quaterniond::Identity(), {0.0, 100.0, 0.0}};
  EXPECT_THROW(
      workflow::DisplayUpToBrightest(caster, sonar, TankParameters(), simulation, {away}, {512, 401}, 60.0),
      DataError);
}

TEST(MeasureRayErrors, OtherModelsAreRefused) {
  ParameterSet parameters = TankParameters();
  parameters.model = EchoModel::kAcoustic;
  const sim::RayCaster caster(sim::MakeMockup());
  const SonarModel& sonar = sim::FindSonarPreset("p900-45").sonar;
  EXPECT_THROW(workflow::MeasureRayErrors(caster, sonar, parameters, {}, {Pose{}}, {}), DataError);
  EXPECT_THROW(workflow::MeasureRayErrors(caster, sonar, TankParameters(), {}, {}, {}), DataError);
}

TEST(RaysCommand, WritesTableJsonAndReport) {
  const TinyWorld world;
  const std::string inputs =
      fmt::format("--scene {} --sonar {} --params {} --poses {}", Quoted(world.scene()),
                  Quoted(world.sonar()), Quoted(world.params()), Quoted(world.poses()));
  const std::string small = " --dense 96x80 --denser 4 --rays 48x40 --rays 96x80";
  const Outcome outcome = RunSonarcal("rays -q " + inputs + small + " --out " + Quoted(world / "rays"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("error against rays over 4 poses"));
  EXPECT_THAT(outcome.out, HasSubstr("48x40"));
  const nlohmann::json json = ReadJsonFile(world / "rays/rays.json");
  EXPECT_EQ(json["poses"], 4);
  ASSERT_EQ(json["counts"].size(), 4U);
  EXPECT_EQ(json["counts"][0]["sampling"], "frustum");
  EXPECT_EQ(json["counts"][0]["rays"], "48x40");
  EXPECT_EQ(json["counts"][0]["count"], 1920);
  EXPECT_EQ(json["counts"][0]["denser"], 16.0);
  EXPECT_EQ(json["ray_weight"], "even");
  EXPECT_GT(json["between_samplings"]["error_grey"]["max"], 0.0);
  EXPECT_EQ(ReadJsonFile(world / "rays/provenance.json")["command"], "rays");
  EXPECT_TRUE(std::filesystem::exists(world / "rays/report.html"));

  const Outcome only = RunSonarcal("rays -q --json " + inputs + small + " --sampling beams");
  ASSERT_EQ(only.status, 0) << only.err;
  const nlohmann::json printed = nlohmann::json::parse(only.out);
  EXPECT_EQ(printed["counts"].size(), 2U);
  EXPECT_EQ(printed["counts"][1], json["counts"][3]);
  EXPECT_FALSE(printed.contains("between_samplings"));

  const Outcome wide =
      RunSonarcal("rays -q --json " + inputs + small + " --ray-weight solid_angle --display-db 60");
  ASSERT_EQ(wide.status, 0) << wide.err;
  const nlohmann::json of_wide = nlohmann::json::parse(wide.out);
  EXPECT_EQ(of_wide["ray_weight"], "solid_angle");
  EXPECT_NE(of_wide["display"], json["display"]);
  EXPECT_NE(of_wide["counts"][0], json["counts"][0]);

  const Outcome wrong = RunSonarcal("rays " + inputs + " --rays 48by40");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_TRUE(IsOneSentence(wrong.err)) << wrong.err;
}

}  // namespace
}  // namespace sonarcal::commands
