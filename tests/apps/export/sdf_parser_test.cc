// Exported models and worlds, read by libsdformat, the parser of Gazebo. It refuses elements that SDF does
// not have. Elements inside a plugin, or with a prefix such as gz:, belong to the plugin. The lists in
// simulator_schemas.h check those.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#ifdef SONARCAL_WITH_SDFORMAT
#include <sdf/Link.hh>
#include <sdf/Model.hh>
#include <sdf/ParserConfig.hh>
#include <sdf/Root.hh>
#include <sdf/World.hh>
#endif

#include "apps/export/simulator_configs.h"

namespace sonarcal::exporting {
namespace {

#ifdef SONARCAL_WITH_SDFORMAT

ExportSource SourceWithScene() {
  ExportSource source;
  source.sonar = {.name = "even",
                  .frequency_hz = 900e3,
                  .axes = {.range_min_m = 0.5, .range_max_m = 8.5, .range_bins = 400, .beam_azimuth_rad = {}},
                  .azimuth_beam_width_deg = 1.0,
                  .elevation_beam_width_deg = 20.0,
                  .sound_speed_m_per_s = 1480.0};
  for (int beam = 0; beam < 91; ++beam)
    source.sonar.axes.beam_azimuth_rad.push_back((beam - 45) * 0.5 * std::numbers::pi / 180.0);
  source.parameters.materials["floor"];
  source.parameters.jitter.sigma_range_m = 0.02;
  Scene scene;
  scene.vertices_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles = {{0, 1, 2}};
  scene.triangle_material = {0};
  scene.material_names = {"floor"};
  source.scene = scene;
  return source;
}

sdf::Errors Load(const std::string& text, sdf::Root& root) {
  sdf::ParserConfig config = sdf::ParserConfig::GlobalConfig();
  config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::ERR);
  config.SetWarningsPolicy(sdf::EnforcementPolicy::ERR);
  return root.LoadSdfString(text, config);
}

void LoadWithoutErrors(const std::string& text, sdf::Root& root) {
  for (const sdf::Error& error : Load(text, root)) ADD_FAILURE() << error.Message();
}

const std::string& WorldText(const ExportedConfig& config) {
  for (const ExportedFile& file : config.files) {
    if (file.suffix == "_world.sdf") return file.text;
  }
  throw std::runtime_error("there is no world");
}

TEST(SdfParserTest, ReadsEveryModelWithItsSensor) {
  for (const auto write : {ExportToDave, ExportToDaveRos2, ExportToGazebo}) {
    sdf::Root root;
    LoadWithoutErrors(write(SourceWithScene(), "sonar").files.front().text, root);
    ASSERT_NE(root.Model(), nullptr);
    ASSERT_EQ(root.Model()->LinkCount(), 1U);
    EXPECT_EQ(root.Model()->LinkByIndex(0)->SensorCount(), 1U);
  }
}

TEST(SdfParserTest, RefusesAnElementThatSdfDoesNotHave) {
  std::string text = ExportToGazebo(SourceWithScene(), "sonar").files.front().text;
  const std::string element = "<always_on>true</always_on>";
  const std::size_t at = text.find(element);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, element.size(), "<always_off>true</always_off>");
  sdf::Root root;
  EXPECT_FALSE(Load(text, root).empty());
}

TEST(SdfParserTest, ReadsEveryWorldWithTheSonarAndTheScene) {
  for (const auto write : {ExportToDaveRos2, ExportToGazebo}) {
    sdf::Root root;
    LoadWithoutErrors(WorldText(write(SourceWithScene(), "sonar")), root);
    ASSERT_EQ(root.WorldCount(), 1U);
    const sdf::World* world = root.WorldByIndex(0);
    EXPECT_TRUE(world->ModelNameExists("sonar"));
    EXPECT_TRUE(world->ModelNameExists("scene_floor"));
    EXPECT_TRUE(world->ModelByName("sonar")->Static());
    // The sonar is at the origin and looks along Y.
    EXPECT_NEAR(world->ModelByName("sonar")->RawPose().Rot().Yaw(), 0.5 * std::numbers::pi, 1e-9);
  }
}

#else

TEST(SdfParserTest, ReadsEveryModelWithItsSensor) {
  GTEST_SKIP() << "libsdformat is not installed (Debian: libsdformat-dev), so no parser reads the SDF files";
}

#endif

}  // namespace
}  // namespace sonarcal::exporting
