// Configurations of other simulators, against what those simulators read (simulator_schemas.h).
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "apps/export/cosine_law.h"
#include "apps/export/simulator_configs.h"
#include "core/types/error.h"
#include "data_io/parameters/parameters_io.h"
#include "tests/apps/export/simulator_schemas.h"

namespace sonarcal::exporting {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::Schema;

constexpr double kDeg = std::numbers::pi / 180.0;

SonarModel EvenSonar() {
  SonarModel sonar{
      .name = "even",
      .frequency_hz = 900e3,
      .axes = {.range_min_m = 0.5, .range_max_m = 8.5, .range_bins = 400, .beam_azimuth_rad = {}},
      .azimuth_beam_width_deg = 1.0,
      .elevation_beam_width_deg = 20.0,
      .sound_speed_m_per_s = 1480.0};
  for (int beam = 0; beam < 90; ++beam) sonar.axes.beam_azimuth_rad.push_back((beam - 44.5) * 0.5 * kDeg);
  return sonar;
}

ExportSource Acoustic() {
  ExportSource source{.parameters = {},
                      .sonar = EvenSonar(),
                      .water = {.temperature_c = 12.0, .salinity_ppt = 33.0, .ph = 8.0, .depth_m = 5.0},
                      .absorption_db_per_m = 0.31};
  ParameterSet& parameters = source.parameters;
  parameters.model = EchoModel::kAcoustic;
  parameters.source_level_db = 210.0;
  parameters.display = {.db_min = 60.0, .db_max = 120.0, .law = DisplayLaw::kSoftLog, .soft_db = 65.0};
  parameters.materials["floor"].gsab = {.a = 0.0, .b_deg = 4.0, .c = 0.01, .d = 2.0, .e = 0.0, .f_deg = 8.0};
  parameters.materials["wall"].gsab = {.a = 0.1, .b_deg = 3.0, .c = 4e-3, .d = 1.0, .e = 0.02, .f_deg = 12.0};
  parameters.mirrors["wall"].loss_db = 6.0;
  parameters.receiver.gain_db = 3.0;
  parameters.receiver.time_varied_gain = TimeVariedGain::k20LogR;
  parameters.receiver.noise_db = 70.0;
  parameters.receiver.noise_slope_db_per_m = 0.1;
  parameters.receiver.noise_taper_db.assign(90, -1.0);
  parameters.receiver.noise_after_gain_db = 62.0;
  parameters.receiver.noise_after_gain_taper_db.assign(90, 0.5);
  parameters.receiver.looks = 4.0;
  parameters.beam.azimuth_width_deg = 0.8;
  parameters.beam.elevation_width_deg = 18.0;
  parameters.beam.transmit_even_deg = 30.0;
  parameters.beam.transmit_end_deg = 45.0;
  parameters.pulse.length_m = 0.03;
  return source;
}

ExportSource Paper() {
  ExportSource source = Acoustic();
  source.parameters = {};
  source.parameters.materials["floor"];
  source.parameters.materials["box"].gsab.a = 180.0;
  source.parameters.noise_level_db = 40.0;
  source.parameters.jitter = {.sigma_range_m = 0.02, .sigma_azimuth_deg = 0.4};
  return source;
}

// A triangle of the floor and one of the wall.
Scene TwoMaterials() {
  Scene scene;
  scene.vertices_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  scene.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.triangle_material = {0, 1};
  scene.material_names = {"floor", "wall"};
  return scene;
}

// A transform with attributes xyz and rpy.
Eigen::Isometry3d TransformOf(const pugi::xml_node& node) {
  std::istringstream numbers(
      fmt::format("{} {}", node.attribute("xyz").value(), node.attribute("rpy").value()));
  Eigen::Vector3d xyz;
  Eigen::Vector3d rpy;
  for (double& value : xyz) numbers >> value;
  for (double& value : rpy) numbers >> value;
  EXPECT_TRUE(numbers);
  return Eigen::Translation3d(xyz) * Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX());
}

struct Simulator {
  const char* name;
  ExportedConfig (*write)(const ExportSource& source, const std::string& name);
  Schema (*schema)();
  bool is_xml;
};
void PrintTo(const Simulator& simulator, std::ostream* stream) {
  *stream << simulator.name;
}

// Everything that a configuration says, by path: "plugin/sonarFreq" -> "900000".
using Said = std::multimap<std::string, std::string>;

void GatherXml(const pugi::xml_node& node, const std::string& path, Said& said) {
  for (const pugi::xml_attribute& attribute : node.attributes())
    said.emplace(fmt::format("{}@{}", path, attribute.name()), attribute.value());
  for (const pugi::xml_node& child : node.children()) {
    if (child.type() != pugi::node_element) continue;
    said.emplace(path + child.name(), child.text().get());
    GatherXml(child, fmt::format("{}{}/", path, child.name()), said);
  }
}

void GatherJson(const nlohmann::json& json, const std::string& path, Said& said) {
  for (const auto& [key, member] : json.items()) {
    said.emplace(path + key, member.dump());
    if (member.is_object() && path + key != "reflectivity") GatherJson(member, path + key + "/", said);
  }
}

Said WhatIsSaid(const ExportedConfig& config, bool is_xml) {
  Said said;
  const std::string& text = config.files.front().text;
  if (!is_xml) {
    GatherJson(nlohmann::json::parse(text), "", said);
    return said;
  }
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(text.c_str())) << text;
  const pugi::xpath_node_set sensors = document.select_nodes("//sensor");
  EXPECT_EQ(sensors.size(), 1U);
  GatherXml(sensors.first().node(), "", said);
  return said;
}

double NumberOf(const Said& said, const std::string& path) {
  const auto found = said.find(path);
  EXPECT_NE(found, said.end()) << path;
  return found == said.end() ? 0.0 : std::stod(found->second);
}

const AccountLine& LineOf(const ExportedConfig& config, const std::string& parameter) {
  for (const AccountLine& line : config.account.Lines()) {
    if (line.parameter == parameter) return line;
  }
  throw std::runtime_error(parameter + " is not in the account");
}

// Leaves of params.json as a user sees it, by the names of fit.json.
std::set<std::string> ParameterNames(const ParameterSet& parameters) {
  std::set<std::string> names;
  const nlohmann::json leaves = nlohmann::json::parse(data_io::ParametersJson(parameters).dump()).flatten();
  for (const auto& [pointer, value] : leaves.items()) {
    std::string name;
    std::istringstream parts(pointer.substr(1));
    for (std::string part; std::getline(parts, part, '/');) {
      if (!part.empty() && std::isdigit(static_cast<unsigned char>(part.front())) != 0) break;  // of an array
      name += (name.empty() ? "" : ".") + part;
    }
    if (name.starts_with("materials.")) name.replace(0, 9, "material");
    if (name != "format" && name != "mirror") names.insert(name);  // "mirror": empty
  }
  return names;
}

class ExportSimulatorTest : public ::testing::TestWithParam<Simulator> {};

TEST_P(ExportSimulatorTest, TheFileHoldsAllAndOnlyTheKeysOfTheSimulator) {
  const Schema schema = GetParam().schema();
  for (const ExportSource& source : {Acoustic(), Paper()}) {
    const Said said = WhatIsSaid(GetParam().write(source, "sonar"), GetParam().is_xml);
    for (const auto& [path, value] : said) EXPECT_TRUE(schema.known.contains(path)) << path;
    for (const std::string& path : schema.required) EXPECT_TRUE(said.contains(path)) << path;
  }
}

TEST_P(ExportSimulatorTest, AccountsForEveryParameterOnce) {
  for (const ExportSource& source : {Acoustic(), Paper()}) {
    const ExportedConfig config = GetParam().write(source, "sonar");
    std::multiset<std::string> accounted;
    for (const AccountLine& line : config.account.Lines()) {
      accounted.insert(line.parameter);
      if (line.expression != Expression::kExported) {
        EXPECT_NE(line.how, "") << line.parameter;
      }
    }
    for (const std::string& name : ParameterNames(source.parameters))
      EXPECT_EQ(accounted.count(name), 1U) << name;
    for (const char* name : {"sonar.frequency_hz", "sonar.beam_azimuth_deg", "sonar.azimuth_beam_width_deg",
                             "sonar.elevation_beam_width_deg", "sonar.range_min_m", "sonar.range_max_m",
                             "sonar.range_bins", "sonar.sound_speed_m_per_s", "water.temperature_c",
                             "water.salinity_ppt", "water.ph", "water.depth_m", "absorption_db_per_m"}) {
      EXPECT_EQ(accounted.count(name), 1U) << name;
    }
  }
}

// What a standard target, a prior and a sonar of several pings add to the parameters.
TEST_P(ExportSimulatorTest, AccountsForPingsAPriorAndAMeasuredSourceLevel) {
  for (ExportSource source : {Acoustic(), Paper()}) {
    source.parameters.source_level_sigma_db = 0.5;
    source.parameters.materials["floor"].prior = "sand";
    source.sonar.pings = {.of_beam = std::vector<int>(90, 1), .period_s = 0.02, .first_s = -0.01};
    const ExportedConfig config = GetParam().write(source, "sonar");
    for (const char* name : {"source_level_sigma_db", "material.floor.prior"})
      EXPECT_EQ(LineOf(config, name).expression, Expression::kUnused) << name;
    for (const char* name : {"sonar.pings.of_beam", "sonar.pings.period_s", "sonar.pings.first_s"})
      EXPECT_EQ(LineOf(config, name).expression, Expression::kNotExpressed) << name;
  }
}

// Where the account says that a parameter went, something stands.
TEST_P(ExportSimulatorTest, EveryTargetOfTheAccountExistsInTheFile) {
  for (const ExportSource& source : {Acoustic(), Paper()}) {
    const ExportedConfig config = GetParam().write(source, "sonar");
    const Said said = WhatIsSaid(config, GetParam().is_xml);
    for (const AccountLine& line : config.account.Lines()) {
      if (line.target.empty() || line.parameter.starts_with("material.")) continue;
      std::istringstream targets(line.target);
      for (std::string target; std::getline(targets >> std::ws, target, ',');) {
        const std::string last = target.substr(target.find_last_of('/') + 1);
        const bool is_there = std::any_of(said.begin(), said.end(), [&](const auto& entry) {
          return entry.first == target || entry.first.ends_with("/" + last) ||
                 entry.first.ends_with("@" + last);
        });
        EXPECT_TRUE(is_there) << line.parameter << " -> " << target;
      }
    }
  }
}

// What is not expressed is read where the configuration itself is: in its comment, if it can have one.
TEST_P(ExportSimulatorTest, TheFileStatesWhatTheSimulatorCannotExpress) {
  const ExportedConfig config = GetParam().write(Acoustic(), "sonar");
  const std::vector<std::string> sentences = config.account.Sentences();
  EXPECT_THAT(sentences, Contains(HasSubstr("not expressed: receiver.time_varied_gain")));
  EXPECT_THAT(sentences, Contains(HasSubstr("approximated: ")));
  if (!GetParam().is_xml) return;
  for (const std::string& sentence : sentences) EXPECT_THAT(config.files.front().text, HasSubstr(sentence));
}

TEST_P(ExportSimulatorTest, UnevenAndTurnedBeamsAreApproximated) {
  ExportSource source = Acoustic();
  source.sonar.axes.beam_azimuth_rad[44] -= 0.2 * kDeg;
  const AccountLine uneven = LineOf(GetParam().write(source, "sonar"), "sonar.beam_azimuth_deg");
  EXPECT_EQ(uneven.expression, Expression::kApproximated);
  EXPECT_THAT(uneven.how, HasSubstr("up to 0.2 degrees off"));
  source = Acoustic();
  for (double& azimuth_rad : source.sonar.axes.beam_azimuth_rad) azimuth_rad += 10.0 * kDeg;
  const ExportedConfig turned = GetParam().write(source, "sonar");
  // These have angles for both ends.
  if (std::string(GetParam().name) == "gazebo" || std::string(GetParam().name) == "dave_ros2") return;
  EXPECT_THAT(LineOf(turned, "sonar.beam_azimuth_deg").how, HasSubstr("turn the sensor by 10 degrees"));
}

TEST_P(ExportSimulatorTest, RefusesASonarWithoutElevation) {
  ExportSource source = Paper();
  source.sonar.elevation_beam_width_deg = 0.0;
  EXPECT_THROW(GetParam().write(source, "sonar"), DataError);
}

// Simulators whose configuration has the level of the noise floor.
TEST(ExportSimulatorsTest, RefusesATaperOfAnotherNumberOfBeams) {
  ExportSource source = Acoustic();
  source.parameters.receiver.noise_taper_db.resize(64);
  for (const auto write : {ExportToHoloOcean, ExportToStonefish, ExportToOceanSim})
    EXPECT_THROW(write(source, "sonar"), DataError);
}

INSTANTIATE_TEST_SUITE_P(
    Simulators, ExportSimulatorTest,
    ::testing::Values(Simulator{"dave", ExportToDave, testing::DaveSchema, true},
                      Simulator{"dave_ros2", ExportToDaveRos2, testing::DaveRos2Schema, true},
                      Simulator{"holoocean", ExportToHoloOcean, testing::HoloOceanSchema, false},
                      Simulator{"stonefish", ExportToStonefish, testing::StonefishSchema, true},
                      Simulator{"oceansim", ExportToOceanSim, testing::OceanSimSchema, false},
                      Simulator{"gazebo", ExportToGazebo, testing::GazeboSchema, true}),
    [](const auto& simulator) { return std::string(simulator.param.name); });

// By the plugin's own formulas: nFreq = ceil(bandwidth 2 maxDistance / c) bins of c / (2 bandwidth), a
// pinhole image whose pixels are square.
TEST(ExportToDaveTest, BinsBeamsAndLevelsAreOurs) {
  const ExportSource source = Acoustic();
  const ExportedConfig config = ExportToDave(source, "p900");
  const Said said = WhatIsSaid(config, true);
  const double bandwidth_hz = NumberOf(said, "plugin/bandwidth");
  EXPECT_NEAR(NumberOf(said, "plugin/soundSpeed") / (2.0 * bandwidth_hz), 0.02, 1e-12);
  EXPECT_NEAR(bandwidth_hz * 2.0 * NumberOf(said, "plugin/maxDistance") / 1480.0, 8.5 / 0.02, 1e-6);
  EXPECT_NEAR(NumberOf(said, "camera/horizontal_fov"), 45.0 * kDeg, 1e-12);
  EXPECT_EQ(NumberOf(said, "camera/image/width"), 90.0);
  const double focal_px = 45.0 / std::tan(22.5 * kDeg);
  const double vertical_deg = 2.0 * std::atan(0.5 * NumberOf(said, "camera/image/height") / focal_px) / kDeg;
  EXPECT_NEAR(vertical_deg, 18.0, 0.55);  // whole rows, about half a degree each
  EXPECT_EQ(NumberOf(said, "plugin/sonarFreq"), 900e3);
  EXPECT_EQ(NumberOf(said, "plugin/sourceLevel"), 210.0);
  EXPECT_EQ(NumberOf(said, "plugin/raySkips"), 1.0);
  EXPECT_EQ(said.find("plugin/customSDFTagDatabaseFile")->second, "p900_reflectivity.csv");

  // As the plugin reads its table: three lines skipped, name and value.
  std::istringstream table(config.files.at(1).text);
  EXPECT_EQ(config.files.at(1).suffix, "_reflectivity.csv");
  std::map<std::string, double> reflectivity;
  std::string line;
  for (int i = 0; i < 3; ++i) std::getline(table, line);
  while (std::getline(table, line)) {
    const std::size_t comma = line.find(',');
    reflectivity[line.substr(0, comma)] = std::stod(line.substr(comma + 1));
  }
  EXPECT_EQ(reflectivity.at("roughness"), 1.0);
  EXPECT_EQ(reflectivity.at("biofouling_rating"), 1.0);
  EXPECT_NEAR(reflectivity.at("floor"), 0.01, 1e-8);  // Lambert's law already
  EXPECT_GT(reflectivity.at("wall"), 4e-3);
  EXPECT_THAT(LineOf(config, "material.floor.gsab.C").how, HasSubstr("up to 0.0 dB off"));
  EXPECT_THAT(LineOf(config, "absorption_db_per_m").how, HasSubstr("0.0354 dB/m, ours is 0.31 dB/m"));
}

// By the formulas of the plugin: an odd number of rays between both angles, whose cones double the vertical
// field.
TEST(ExportToDaveRos2Test, RaysCoverOurFieldOfView) {
  const Said said = WhatIsSaid(ExportToDaveRos2(Acoustic(), "sonar"), true);
  const std::string ray = "gz:multibeam_sonar/ray/";
  EXPECT_EQ(NumberOf(said, ray + "scan/horizontal/beams"), 91.0);
  EXPECT_NEAR(NumberOf(said, ray + "scan/horizontal/max_angle"), 22.25 * kDeg, 1e-12);
  const double field_rad =
      NumberOf(said, ray + "scan/vertical/max_angle") - NumberOf(said, ray + "scan/vertical/min_angle");
  EXPECT_NEAR(2.0 * field_rad, 18.0 * kDeg, 1e-12);
  EXPECT_EQ(std::fmod(NumberOf(said, ray + "scan/vertical/rays"), 2.0), 1.0);
  EXPECT_EQ(NumberOf(said, "gz:multibeam_sonar/spec/raySkips"), 1.0);
  EXPECT_EQ(said.find(ray + "@degrees")->second, "false");
}

const ExportedFile& WorldOf(const ExportedConfig& config) {
  for (const ExportedFile& file : config.files) {
    if (file.suffix == "_world.sdf") return file;
  }
  throw std::runtime_error("there is no world");
}

std::set<std::string> PluginsOf(const pugi::xml_node& world) {
  std::set<std::string> plugins;
  for (const pugi::xml_node& plugin : world.children("plugin"))
    plugins.insert(
        fmt::format("{} {}", plugin.attribute("filename").value(), plugin.attribute("name").value()));
  return plugins;
}

TEST(ExportWorldTest, NamesThePluginsThatTheSensorNeeds) {
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(WorldOf(ExportToGazebo(Acoustic(), "sonar")).text.c_str()));
  EXPECT_THAT(PluginsOf(document.child("sdf").child("world")),
              Contains("gz-sim-sensors-system gz::sim::systems::Sensors"));
  ASSERT_TRUE(document.load_string(WorldOf(ExportToDaveRos2(Acoustic(), "sonar")).text.c_str()));
  const std::set<std::string> plugins = PluginsOf(document.child("sdf").child("world"));
  EXPECT_THAT(plugins, Contains("gz-sim-sensors-system gz::sim::systems::Sensors"));
  EXPECT_THAT(plugins, Contains("multibeam_sonar_system custom::MultibeamSonarSystem"));
}

// Gazebo's sensors look along X, with Y to the left.
TEST(ExportWorldTest, TheModelLooksWhereTheSonarLooks) {
  ExportSource source = Acoustic();
  source.scene = TwoMaterials();
  source.world_from_sonar = Pose{RotationFromYawPitchRoll(0.7, -0.3, 0.2), {1.0, -2.0, 0.5}};
  const ExportedConfig config = ExportToGazebo(source, "sonar");
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(WorldOf(config).text.c_str()));
  const pugi::xml_node world = document.child("sdf").child("world");
  const pugi::xml_node model = world.find_child_by_attribute("model", "name", "sonar");
  std::istringstream numbers(model.child_value("pose"));
  std::string x, y, z, roll, pitch, yaw;
  numbers >> x >> y >> z >> roll >> pitch >> yaw;
  pugi::xml_document holder;
  pugi::xml_node node = holder.append_child("pose");
  node.append_attribute("xyz") = fmt::format("{} {} {}", x, y, z).c_str();
  node.append_attribute("rpy") = fmt::format("{} {} {}", roll, pitch, yaw).c_str();
  const Eigen::Vector3d point(0.3, 4.0, -1.2);
  const Eigen::Vector3d theirs = TransformOf(node).inverse() * point;
  const Eigen::Vector3d ours = source.world_from_sonar->Inverse() * point;
  EXPECT_NEAR((theirs - Eigen::Vector3d(ours.y(), -ours.x(), ours.z())).norm(), 0.0, 1e-9);
  EXPECT_EQ(config.files.size(), 4U);  // model, world, two meshes
  EXPECT_TRUE(world.find_child_by_attribute("model", "name", "scene_wall"));
}

TEST(ExportToDaveTest, NamesThatItsTableCannotHoldAreRefused) {
  for (const char* name : {"a,b", "roughness"}) {
    ExportSource source = Acoustic();
    source.parameters.materials[name];
    EXPECT_THROW(ExportToDave(source, "p900"), DataError) << name;
  }
}

TEST(ExportToHoloOceanTest, FieldOfViewBinsAndNoiseEqualOurs) {
  const ExportSource source = Acoustic();
  const Said said = WhatIsSaid(ExportToHoloOcean(source, "sonar"), false);
  EXPECT_NEAR(NumberOf(said, "configuration/Azimuth"), 45.0, 1e-9);
  EXPECT_EQ(NumberOf(said, "configuration/Elevation"), 18.0);
  EXPECT_EQ(NumberOf(said, "configuration/AzimuthBins"), 90.0);
  EXPECT_EQ(NumberOf(said, "configuration/RangeBins"), 400.0);
  // The engine multiplies by 0.5 + sigma n: a spread of sigma / 0.5.
  EXPECT_EQ(NumberOf(said, "configuration/MultSigma") / 0.5, 0.5);
  EXPECT_EQ(said.find("configuration/MultiPath")->second, "true");
  // Both floors at 8.5 m, in dB, over full scale; a Rayleigh law's mean is 1.2533 sigma.
  const double before_db = 70.0 + 0.1 * 8.5 - 1.0 + 20.0 * std::log10(8.5);
  const double floor = std::pow(10.0, (before_db - 120.0) / 10.0) + std::pow(10.0, (62.5 - 120.0) / 10.0);
  EXPECT_NEAR(NumberOf(said, "configuration/AddSigma") * 1.253314137, floor, 1e-9 * floor);
  EXPECT_EQ(NumberOf(WhatIsSaid(ExportToHoloOcean(Paper(), "sonar"), false), "configuration/RangeSigma"),
            0.02);
}

TEST(ExportToStonefishTest, FieldOfViewBinsAndNoiseEqualOurs) {
  const ExportSource source = Acoustic();
  const ExportedConfig config = ExportToStonefish(source, "sonar");
  const Said said = WhatIsSaid(config, true);
  EXPECT_EQ(said.find("@type")->second, "fls");
  EXPECT_NEAR(NumberOf(said, "specs/@horizontal_fov"), 45.0, 1e-9);
  EXPECT_EQ(NumberOf(said, "specs/@vertical_fov"), 18.0);
  EXPECT_EQ(NumberOf(said, "specs/@bins"), 400.0);
  EXPECT_EQ(NumberOf(said, "settings/@range_max"), 8.5);
  EXPECT_EQ(NumberOf(said, "noise/@multiplicative"), 0.5);
}

Said ScenarioOf(const ExportedConfig& config, pugi::xml_document& document) {
  EXPECT_TRUE(document.load_string(config.files.front().text.c_str()));
  Said said;
  pugi::xml_node scenario = document.child("scenario");
  GatherXml(scenario, "", said);
  return said;
}

TEST(ExportToStonefishTest, TheScenarioHasAllThatTheParserRefusesToBeWithout) {
  ExportSource source = Acoustic();
  source.scene = TwoMaterials();
  const Schema schema = testing::StonefishScenarioSchema();
  pugi::xml_document document;
  const Said said = ScenarioOf(ExportToStonefish(source, "sonar"), document);
  for (const auto& [path, value] : said) {
    if (path.starts_with("sensor/")) continue;  // StonefishSchema
    EXPECT_TRUE(schema.known.contains(path)) << path;
  }
  for (const std::string& path : schema.required) EXPECT_TRUE(said.contains(path)) << path;
}

TEST(ExportToStonefishTest, EveryMaterialLookAndMeshIsThere) {
  ExportSource source = Acoustic();
  source.scene = TwoMaterials();
  const ExportedConfig config = ExportToStonefish(source, "sonar");
  pugi::xml_document document;
  ScenarioOf(config, document);
  const pugi::xml_node scenario = document.child("scenario");
  std::map<std::string, double> restitutions;
  for (const pugi::xml_node& material : scenario.child("materials").children())
    restitutions[material.attribute("name").value()] = material.attribute("restitution").as_double();
  EXPECT_EQ(restitutions.at("wall"), 1.0);  // the strongest
  EXPECT_LT(restitutions.at("floor"), 1.0);
  std::set<std::string> meshes;
  for (const pugi::xml_node& body : scenario.children("static")) {
    EXPECT_TRUE(restitutions.contains(body.child("material").attribute("name").value()));
    EXPECT_STREQ(body.child("look").attribute("name").value(), "plain");
    meshes.insert(body.child("physical").child("mesh").attribute("filename").value());
  }
  ASSERT_EQ(config.files.size(), 3U);
  for (std::size_t i = 1; i < config.files.size(); ++i)
    EXPECT_TRUE(meshes.contains("sonar" + config.files[i].suffix));
}

// Compares the place of a point of the scene for the sonar by our pose and by the transforms of the scenario.
// Rotations are Rz(yaw) Ry(pitch) Rx(roll); a sonar of Stonefish has X right, Y down, Z ahead.
TEST(ExportToStonefishTest, TheSonarSeesTheSceneFromOurPose) {
  for (const double pitch_rad : {0.0, -0.3, 0.5 * std::numbers::pi}) {
    ExportSource source = Acoustic();
    source.scene = TwoMaterials();
    source.world_from_sonar = Pose{RotationFromYawPitchRoll(0.7, pitch_rad, 0.2), {1.0, -2.0, 0.5}};
    pugi::xml_document document;
    ScenarioOf(ExportToStonefish(source, "sonar"), document);
    const pugi::xml_node scenario = document.child("scenario");
    const Eigen::Isometry3d world_from_body = TransformOf(scenario.child("static").child("world_transform"));
    const Eigen::Isometry3d world_from_fls = TransformOf(scenario.child("sensor").child("world_transform"));
    const Eigen::Vector3d point(0.3, 4.0, -1.2);
    const Eigen::Vector3d theirs = world_from_fls.inverse() * (world_from_body * point);
    const Eigen::Vector3d ours = source.world_from_sonar->Inverse() * point;
    EXPECT_NEAR(theirs.x(), ours.x(), 1e-9);
    EXPECT_NEAR(theirs.y(), -ours.z(), 1e-9);
    EXPECT_NEAR(theirs.z(), ours.y(), 1e-9);
  }
}

TEST(ExportToStonefishTest, AMaterialWithoutParametersIsRefused) {
  ExportSource source = Acoustic();
  source.scene = TwoMaterials();
  source.scene->material_names[0] = "unknown";
  EXPECT_THROW(ExportToStonefish(source, "sonar"), DataError);
}

// As its code counts bins: numpy.arange(min_range, max_range, range_res), and exp(-attenuation r) on an
// intensity.
TEST(ExportToOceanSimTest, FieldOfViewBinsAndAttenuationEqualOurs) {
  const ExportSource source = Acoustic();
  const Said said = WhatIsSaid(ExportToOceanSim(source, "sonar"), false);
  const double bins =
      (NumberOf(said, "ImagingSonarSensor/max_range") - NumberOf(said, "ImagingSonarSensor/min_range")) /
      NumberOf(said, "ImagingSonarSensor/range_res");
  EXPECT_NEAR(bins, 400.0, 1e-9);
  const Said odd = WhatIsSaid(ExportToOceanSim(source, "p900-45 b"), false);
  EXPECT_EQ(odd.find("ImagingSonarSensor/prim_path")->second, "\"/World/sonar_p900_45_b\"");
  EXPECT_NEAR(
      NumberOf(said, "ImagingSonarSensor/hori_fov") / NumberOf(said, "ImagingSonarSensor/angular_res"), 90.0,
      1e-9);
  const double range_m = 7.0;
  EXPECT_NEAR(std::exp(-NumberOf(said, "make_sonar_data/attenuation") * range_m),
              std::pow(10.0, -2.0 * 0.31 * range_m / 10.0), 1e-12);
  // Intensities are multiplied by 0.5 + sigma n: a spread of sigma / 0.5.
  EXPECT_EQ(NumberOf(said, "make_sonar_data/gau_noise_param") / 0.5, 0.5);
}

// Ray i of the horizontal scan goes by min_angle + i (max_angle - min_angle) / (samples - 1), to the left.
TEST(ExportToGazeboTest, RaysGoThroughTheMiddleOfBeams) {
  ExportSource source = Acoustic();
  for (double& azimuth_rad : source.sonar.axes.beam_azimuth_rad) azimuth_rad += 3.0 * kDeg;
  const Said said = WhatIsSaid(ExportToGazebo(source, "sonar"), true);
  const int samples = static_cast<int>(NumberOf(said, "lidar/scan/horizontal/samples"));
  ASSERT_EQ(samples, 90);
  const double min_rad = NumberOf(said, "lidar/scan/horizontal/min_angle");
  const double max_rad = NumberOf(said, "lidar/scan/horizontal/max_angle");
  EXPECT_LT(min_rad, max_rad);
  for (const int ray : {0, 1, 40, 89}) {
    const double to_left_rad = min_rad + ray * (max_rad - min_rad) / (samples - 1);
    EXPECT_NEAR(-to_left_rad, source.sonar.axes.beam_azimuth_rad[89 - ray], 1e-12) << ray;
  }
  EXPECT_NEAR(NumberOf(said, "lidar/scan/vertical/max_angle"), 9.0 * kDeg, 1e-12);
}

// By brute force: of many coefficients the one whose curve lies as much above as below.
TEST(CosineLawTest, IsTheCurveInTheMiddle) {
  const GsabParameters<double> gsab{.a = 0.1, .b_deg = 3.0, .c = 4e-3, .d = 1.0, .e = 0.02, .f_deg = 12.0};
  for (const double exponent : {1.0, 2.0}) {
    double best = 0.0;
    double least_db = 1e9;
    double worst_db = 0.0;
    for (double k = 1e-3; k < 0.1; k *= 1.0005) {
      double sum_db = 0.0;
      double most_db = 0.0;
      for (int degree = 0; degree <= 75; ++degree) {
        const double x = degree;
        const double ours =
            0.1 * std::exp(-x * x / 18.0) + 4e-3 * std::cos(x * kDeg) + 0.02 * std::exp(-x * x / 288.0);
        const double off_db = 10.0 * std::log10(ours / (k * std::pow(std::cos(x * kDeg), exponent)));
        sum_db += off_db;
        most_db = std::max(most_db, std::abs(off_db));
      }
      if (std::abs(sum_db) >= least_db) continue;
      least_db = std::abs(sum_db);
      best = k;
      worst_db = most_db;
    }
    const CosineLaw law = FitCosineLaw(gsab, exponent);
    EXPECT_NEAR(law.coefficient / best, 1.0, 1e-3) << exponent;
    EXPECT_NEAR(law.worst_db, worst_db, 0.01) << exponent;
  }
}

TEST(CosineLawTest, IsExactForAPowerOfTheCosine) {
  const CosineLaw law =
      FitCosineLaw({.a = 0.0, .b_deg = 4.0, .c = 0.02, .d = 2.0, .e = 0.0, .f_deg = 8.0}, 2.0);
  EXPECT_NEAR(law.coefficient, 0.02, 1e-12);
  EXPECT_NEAR(law.worst_db, 0.0, 1e-9);
}

TEST(ExportAccountTest, AParameterWithoutAnAccountIsAProgrammersMistake) {
  EXPECT_THROW(ExportAccount(Acoustic()).Lines(), std::logic_error);
}

}  // namespace
}  // namespace sonarcal::exporting
