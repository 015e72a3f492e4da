// Stonefish's forward-looking sonar: a sensor of type "fls" in a scenario file. Source:
// github.com/patrykcieslak/stonefish b21eb8e: docs/sensors.rst, docs/materials.rst,
// Library/src/core/ScenarioParser.cpp (attributes), Library/shaders/sonarInput.frag and flsOutput.comp (a
// value is gain times the mean of restitution cos(incidence) over a bin's rays, with noise).
#include <fmt/format.h>

#include <pugixml.hpp>

#include "apps/export/even_fan.h"
#include "apps/export/export_words.h"
#include "apps/export/simulator_configs.h"
#include "apps/export/xml_text.h"

namespace sonarcal::exporting {
namespace {

void SetAttribute(pugi::xml_node node, const char* name, double value) {
  node.append_attribute(name) = fmt::format("{:.12g}", value).c_str();
}

}  // namespace

ExportedConfig ExportToStonefish(const ExportSource& source, const std::string& name) {
  const ParameterSet& parameters = source.parameters;
  const PolarAxes& axes = source.sonar.axes;
  const EvenFan fan = EvenFanOf(source);
  const auto laws = FitCosineLaws(parameters, 1.0);

  ExportedConfig config{
      .files = {}, .account = ExportAccount(source), .schema = "Stonefish b21eb8e, sensor of type fls"};
  pugi::xml_document document;
  pugi::xml_node sensor = document.append_child("scenario").append_child("sensor");
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
  pugi::xml_node place = sensor.append_child("world_transform");
  place.append_attribute("xyz") = "0.0 0.0 0.0";
  place.append_attribute("rpy") = "0.0 0.0 0.0";

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

  // Materials are in the main file of a scenario, with a density, which is unknown here.
  std::string remarks =
      "Move the sensor into your robot (then world_transform becomes origin, with a link), and set the\n"
      "  restitution of your materials (attribute of material, in the scenario's main file):";
  for (const auto& [material, restitution] : RelativeReflectivities(laws)) {
    remarks += fmt::format("\n    {}: {:.6g}", material, restitution);
  }
  config.files.push_back({"", XmlText(document, config.schema, remarks, account)});
  return config;
}

}  // namespace sonarcal::exporting
