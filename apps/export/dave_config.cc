// DAVE's multibeam sonar: plugin nps_uw_multibeam_sonar of Gazebo classic. Source:
// github.com/Field-Robotics-Lab/nps_uw_multibeam_sonar 47dae1f: src/gazebo_multibeam_sonar_raster_based.cpp
// (elements of the plugin, the table of reflectivities), src/sonar_calculation_cuda.cu (the echo),
// models/oculus_m1200d_nps_multibeam_customSDFTag/model.sdf.
//
// The power of an echo there is mu cos^2(incidence) times area, source level and spreading. Each column of
// the depth image is a beam, each row a ray. Time bins are c / (2 bandwidth) long and begin at range 0.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <pugixml.hpp>

#include "apps/export/dave_echo.h"
#include "apps/export/even_fan.h"
#include "apps/export/export_words.h"
#include "apps/export/simulator_configs.h"
#include "apps/export/xml_text.h"
#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::exporting {
namespace {

constexpr double kLambert = 2.0;
constexpr double kDefaultReflectivity = 1e-3;  // default of the plugin, for materials not in its table

// Returns mu of each material. The paper's model has levels of rays, not of areas, so only ratios are known.
// The strongest is set to the plugin's default.
std::map<std::string, double> Reflectivities(const ParameterSet& parameters,
                                             const std::map<std::string, CosineLaw>& laws) {
  std::map<std::string, double> reflectivities;
  if (parameters.model != EchoModel::kPaper) {
    for (const auto& [name, law] : laws) reflectivities[name] = law.coefficient;
    return reflectivities;
  }
  for (const auto& [name, relative] : RelativeReflectivities(laws)) {
    reflectivities[name] = kDefaultReflectivity * relative;
  }
  return reflectivities;
}

// The plugin skips three lines, and looks up names line by line.
std::string ReflectivityTable(const std::map<std::string, double>& reflectivities) {
  std::string text =
      "# Written by sonarcal export\n"
      "# Reflectivity by surface_props:material of a model; roughness and biofouling change nothing\n"
      "# name, value\n"
      "biofouling_rating,1\n"
      "roughness,1\n";
  for (const auto& [name, reflectivity] : reflectivities) {
    if (name.find_first_of(",\n\r") != std::string::npos || name == "biofouling_rating" ||
        name == "roughness") {
      throw DataError("the material '{}' cannot be named in DAVE's table, expected a name without commas",
                      name);
    }
    text += fmt::format("{},{:.6g}\n", name, reflectivity);
  }
  return text;
}

}  // namespace

ExportedConfig ExportToDave(const ExportSource& source, const std::string& name) {
  const ParameterSet& parameters = source.parameters;
  const SonarModel& sonar = source.sonar;
  const EvenFan fan = EvenFanOf(source);
  const auto laws = FitCosineLaws(parameters, kLambert);
  const std::string table_suffix = "_reflectivity.csv";
  const double half_field = std::tan(RadFromDeg(0.5 * fan.field_deg));
  const double half_elevation = std::tan(RadFromDeg(0.5 * fan.elevation_deg));
  const int rows = std::max(1, static_cast<int>(std::lround(fan.beams * half_elevation / half_field)));
  const double bandwidth_hz = sonar.sound_speed_m_per_s / (2.0 * sonar.axes.range_bin_m());

  ExportedConfig config{.files = {},
                        .account = ExportAccount(source),
                        .schema = "nps_uw_multibeam_sonar 47dae1f (DAVE), SDF 1.6"};
  pugi::xml_document document;
  pugi::xml_node sensor = AddSdfSensor(document, {.version = "1.6",
                                                  .model = name,
                                                  .link = "forward_sonar_link",
                                                  .name = "image_sonar",
                                                  .type = "depth"});
  pugi::xml_node camera = sensor.append_child("camera");
  AddElement(camera, "horizontal_fov", RadFromDeg(fan.field_deg));
  pugi::xml_node image = camera.append_child("image");
  AddElement(image, "width", fan.beams);
  AddElement(image, "height", rows);
  AddElement(image, "format", "R8G8B8");
  pugi::xml_node clip = camera.append_child("clip");
  AddElement(clip, "near", std::max(sonar.axes.range_min_m, sonar.axes.range_bin_m()));
  AddElement(clip, "far", sonar.axes.range_max_m);
  AddElement(camera.append_child("depth_camera"), "output", "depths");
  pugi::xml_node plugin = sensor.append_child("plugin");
  plugin.append_attribute("filename") = "libnps_multibeam_sonar_ros_plugin.so";
  plugin.append_attribute("name") = "forward_sonar";
  AddElement(plugin, "verticalFOV", fan.elevation_deg);
  AddElement(plugin, "sonarFreq", sonar.frequency_hz);
  AddElement(plugin, "bandwidth", bandwidth_hz);
  AddElement(plugin, "soundSpeed", sonar.sound_speed_m_per_s);
  AddElement(plugin, "maxDistance", sonar.axes.range_max_m);
  AddElement(plugin, "sourceLevel", parameters.source_level_db);
  AddElement(plugin, "raySkips", kDaveRaySkips);
  AddElement(plugin, "constantReflectivity", "false");
  AddElement(plugin, "customSDFTagReflectivity", "true");
  AddElement(plugin, "customSDFTagDatabaseFile", name + table_suffix);

  ExportAccount& account = config.account;
  AccountForBeams(fan, "camera/horizontal_fov, camera/image/width", account,
                  "beams are columns of a plane picture, evenly spaced in it rather than in angle");
  account.Exported("sonar.frequency_hz", "plugin/sonarFreq");
  account.Exported("sonar.sound_speed_m_per_s", "plugin/soundSpeed");
  account.Exported("sonar.range_max_m", "plugin/maxDistance, camera/clip/far");
  account.Approximated("sonar.range_min_m", "camera/clip/near",
                       "bins begin at range 0; what is nearer than the window is not seen");
  account.Approximated(
      "sonar.range_bins", "plugin/bandwidth",
      fmt::format("bins are c / (2 bandwidth) = {:.6g} m long, as ours, and begin at range 0",
                  sonar.axes.range_bin_m()));
  const std::string elevation =
      fmt::format("{} rows of rays between hard edges; ours has a pattern beyond its half-power width", rows);
  AccountForElevation("plugin/verticalFOV, camera/image/height", elevation, account);
  const std::string width = fmt::format(
      "a beam is as wide as its spacing, {:.4g} degrees, with DAVE's own pattern", fan.spacing_deg());
  account.Approximated("sonar.azimuth_beam_width_deg", "", width);
  account.Approximated("beam.azimuth_", "", width);
  account.Exported("source_level_db", "plugin/sourceLevel",
                   "the plugin gives each ray raySkips + 1 = 2 rows of area, 3 dB more than it has, and lets "
                   "the area grow with range, not its square");
  AccountForMaterials(
      laws, table_suffix.substr(1) + ": {}",
      parameters.model == EchoModel::kPaper
          ? "; ratios of materials alone, as the paper's model has levels of rays, not of areas"
          : "",
      account);
  AccountForDaveEcho(source, "plugin/bandwidth", account);

  const std::string remarks = fmt::format(
      "Put {}{} into worlds/ of nps_uw_multibeam_sonar, and give each model of the world\n"
      "  <surface_props:material>NAME</surface_props:material> with a name of that table.",
      name, table_suffix);
  config.files.push_back({"", XmlText(document, config.schema, remarks, account)});
  config.files.push_back({table_suffix, ReflectivityTable(Reflectivities(parameters, laws))});
  return config;
}

}  // namespace sonarcal::exporting
