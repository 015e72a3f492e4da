// Stonefish's forward-looking sonar: a sensor of type "fls" in a scenario file. Source:
// github.com/patrykcieslak/stonefish b21eb8e: docs/sensors.rst, docs/materials.rst, docs/scenario.rst,
// Library/src/core/ScenarioParser.cpp (elements and attributes), Library/src/utils/GeometryFileUtil.cpp
// (OBJ), Library/src/sensors/vision/FLS.cpp (axes), Library/shaders/sonarInput.frag and flsOutput.comp (a
// value is gain times the mean of restitution cos(incidence) over a bin's rays, with noise).
//
// The parser refuses a scenario without an environment with NED, or without materials. A static body needs a
// material, a look and a world_transform. Its world has X north, Y east and Z down; a sonar has X right, Y
// down and Z ahead. There is no ocean: its surface has a fixed height, which a scene does not state.
#include <fmt/format.h>

#include <map>

#include <pugixml.hpp>

#include "apps/export/even_fan.h"
#include "apps/export/export_words.h"
#include "apps/export/scene_parts.h"
#include "apps/export/simulator_configs.h"
#include "apps/export/xml_text.h"
#include "core/types/error.h"

namespace sonarcal::exporting {
namespace {

constexpr double kWaterDensityKgPerM3 = 1000.0;  // static bodies do not use it, but the parser needs one
constexpr const char* kLook = "plain";
constexpr const char* kNoMove = "0 0 0";

void SetAttribute(pugi::xml_node node, const char* name, double value) {
  node.append_attribute(name) = fmt::format("{:.12g}", value).c_str();
}

void SetTransform(pugi::xml_node node, const std::string& xyz, const std::string& rpy) {
  node.append_attribute("xyz") = xyz.c_str();
  node.append_attribute("rpy") = rpy.c_str();
}

// Rotation from our world, with Z up, to that of Stonefish: half a turn about X.
Eigen::Matrix3d NedFromWorld() {
  return Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
}

Eigen::Matrix3d SonarFromFls() {
  Eigen::Matrix3d rotation;
  rotation << 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0;
  return rotation;
}

// The parser takes ${...} for a formula, also in a name.
void CheckName(const std::string& material) {
  if (material.find("${") != std::string::npos) {
    throw DataError("the material '{}' cannot be named in a scenario, expected a name without ${{", material);
  }
}

void AddEnvironment(pugi::xml_node scenario) {
  pugi::xml_node ned = scenario.append_child("environment").append_child("ned");
  SetAttribute(ned, "latitude", 0.0);
  SetAttribute(ned, "longitude", 0.0);
}

void AddMaterials(pugi::xml_node scenario, const std::map<std::string, double>& restitutions) {
  pugi::xml_node materials = scenario.append_child("materials");
  for (const auto& [name, restitution] : restitutions) {
    CheckName(name);
    pugi::xml_node material = materials.append_child("material");
    material.append_attribute("name") = name.c_str();
    SetAttribute(material, "density", kWaterDensityKgPerM3);
    SetAttribute(material, "restitution", restitution);
  }
  pugi::xml_node look = scenario.append_child("looks").append_child("look");
  look.append_attribute("name") = kLook;
  SetAttribute(look, "gray", 0.5);
  SetAttribute(look, "roughness", 0.9);
}

// One static body per material of the scene.
void AddScene(pugi::xml_node scenario, const ExportSource& source, const std::string& name,
              std::vector<ExportedFile>& files) {
  for (const ScenePart& part : ScenePartsOf(source)) {
    source.parameters.Material(part.material);  // throws if there is none
    const bool has_own = source.parameters.materials.contains(part.material);
    pugi::xml_node body = scenario.append_child("static");
    body.append_attribute("name") = ("scene_" + part.name).c_str();
    body.append_attribute("type") = "model";
    pugi::xml_node physical = body.append_child("physical");
    physical.append_child("mesh").append_attribute("filename") = (name + part.file.suffix).c_str();
    SetTransform(physical.append_child("origin"), kNoMove, kNoMove);
    body.append_child("material").append_attribute("name") = has_own ? part.material.c_str() : "default";
    body.append_child("look").append_attribute("name") = kLook;
    SetTransform(body.append_child("world_transform"), kNoMove, VectorText(RollPitchYaw(NedFromWorld())));
    files.push_back(part.file);
  }
}

}  // namespace

ExportedConfig ExportToStonefish(const ExportSource& source, const std::string& name) {
  const ParameterSet& parameters = source.parameters;
  const PolarAxes& axes = source.sonar.axes;
  const EvenFan fan = EvenFanOf(source);
  const auto laws = FitCosineLaws(parameters, 1.0);

  ExportedConfig config{.files = {},
                        .account = ExportAccount(source),
                        .schema = "Stonefish b21eb8e, scenario with a sensor of type fls"};
  config.files.resize(1);
  pugi::xml_document document;
  pugi::xml_node scenario = document.append_child("scenario");
  AddEnvironment(scenario);
  AddMaterials(scenario, RelativeReflectivities(laws));
  AddScene(scenario, source, name, config.files);
  pugi::xml_node sensor = scenario.append_child("sensor");
  sensor.append_attribute("name") = name.c_str();
  sensor.append_attribute("type") = "fls";
  pugi::xml_node specs = sensor.append_child("specs");
  SetAttribute(specs, "beams", fan.beams);
  SetAttribute(specs, "bins", axes.range_bins);
  SetAttribute(specs, "horizontal_fov", fan.field_deg);
  SetAttribute(specs, "vertical_fov", fan.elevation_deg);
  pugi::xml_node settings = sensor.append_child("settings");
  SetAttribute(settings, "range_min", axes.range_min_m);
  SetAttribute(settings, "range_max", axes.range_max_m);
  pugi::xml_node noise = sensor.append_child("noise");
  SetAttribute(noise, "multiplicative", SpeckleSpread(parameters));
  SetAttribute(noise, "additive", FloorOfFullScale(source));
  const Pose pose = SonarPoseOf(source);
  SetTransform(sensor.append_child("world_transform"), VectorText(NedFromWorld() * pose.position_m),
               VectorText(RollPitchYaw(NedFromWorld() * pose.rotation.toRotationMatrix() * SonarFromFls())));

  ExportAccount& account = config.account;
  AccountForBeams(fan, "specs/horizontal_fov, specs/beams", account);
  account.Exported("sonar.range_min_m", "settings/range_min");
  account.Exported("sonar.range_max_m", "settings/range_max");
  account.Exported("sonar.range_bins", "specs/bins");
  AccountForElevation("specs/vertical_fov",
                      "the full field of view; Stonefish fades a fifth of it at either end, ours falls to "
                      "half power at the width given",
                      account);
  account.Approximated(
      "receiver.looks", "noise/multiplicative",
      "a normal factor of the spread of speckle, 1 / sqrt(looks), the same for all bins of a "
      "beam");
  AccountForFloor(
      "noise/additive",
      "normal noise whose spread is the floor at the far end of the window, relative to full scale", account);
  AccountForMaterials(laws, "materials/material[{}]/restitution",
                      "; relative to the strongest material, as Stonefish has no levels", account);
  account.NotExpressed("absorption_db_per_m", "Stonefish has neither spreading nor absorption");
  account.NotExpressed("water.", "Stonefish has neither spreading nor absorption");
  AccountForTheRest("Stonefish", account);

  const std::string remarks =
      "Start Stonefish with the folder of this file as its data path: meshes are looked up there.\n"
      "  On a robot, the sensor has an origin and a link in place of world_transform.";
  config.files.front() = {"", XmlText(document, config.schema, remarks, account)};
  return config;
}

}  // namespace sonarcal::exporting
