// Gazebo's gpu_lidar. Source: github.com/gazebosim/sdformat 2ace536, sdf/1.9/lidar.sdf and sensor.sdf. Its
// sensor of type "sonar" is a single cone and gives one range.
//
// X looks ahead, Y to the left, so angles have the opposite sign of our azimuths. Rays go from min_angle to
// max_angle, both included.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <pugixml.hpp>

#include "apps/export/even_fan.h"
#include "apps/export/export_words.h"
#include "apps/export/sdf_world.h"
#include "apps/export/simulator_configs.h"
#include "apps/export/xml_text.h"
#include "core/types/units.h"

namespace sonarcal::exporting {

ExportedConfig ExportToGazebo(const ExportSource& source, const std::string& name) {
  const PolarAxes& axes = source.sonar.axes;
  const EvenFan fan = EvenFanOf(source);
  const double half_elevation_rad = RadFromDeg(0.5 * fan.elevation_deg);
  // The spacing in elevation equals that of the beams in azimuth. Includes one ray in the middle and both
  // ends.
  const int rows =
      2 * std::max(1, static_cast<int>(std::lround(0.5 * fan.elevation_deg / fan.spacing_deg()))) + 1;

  ExportedConfig config{
      .files = {}, .account = ExportAccount(source), .schema = "SDF 1.9, sensor of type gpu_lidar"};
  pugi::xml_document document;
  pugi::xml_node sensor = AddSdfSensor(
      document,
      {.version = "1.9", .model = name, .link = "sonar_link", .name = "sonar_rays", .type = "gpu_lidar"});
  pugi::xml_node lidar = sensor.append_child("lidar");
  pugi::xml_node scan = lidar.append_child("scan");
  const auto add_axis = [&](const char* axis, int samples, double min_rad, double max_rad) {
    pugi::xml_node node = scan.append_child(axis);
    AddElement(node, "samples", samples);
    AddElement(node, "resolution", 1);
    AddElement(node, "min_angle", min_rad);
    AddElement(node, "max_angle", max_rad);
  };
  add_axis("horizontal", fan.beams, RadFromDeg(-fan.last_deg), RadFromDeg(-fan.first_deg));
  add_axis("vertical", rows, -half_elevation_rad, half_elevation_rad);
  pugi::xml_node range = lidar.append_child("range");
  AddElement(range, "min", axes.range_min_m);
  AddElement(range, "max", axes.range_max_m);
  AddElement(range, "resolution", axes.range_bin_m());
  ExportAccount& account = config.account;
  const JitterParameters<double>& jitter = source.parameters.jitter;
  if (source.parameters.model == EchoModel::kPaper && jitter.sigma_range_m > 0.0) {
    pugi::xml_node noise = lidar.append_child("noise");
    AddElement(noise, "type", "gaussian");
    AddElement(noise, "mean", 0.0);
    AddElement(noise, "stddev", jitter.sigma_range_m);
    account.Approximated("jitter.sigma_range_m", "lidar/noise/stddev", "does not grow with range");
  }

  const std::string beams = "scan/horizontal";
  if (fan.IsEven()) {
    account.Exported("sonar.beam_azimuth_deg", beams,
                     "one ray in the middle of each beam; beam 0 is the last");
  } else {
    account.Approximated("sonar.beam_azimuth_deg", beams,
                         fmt::format("rays are spaced evenly, up to {:.3g} degrees off our beams; beam 0 is "
                                     "the last",
                                     fan.worst_deg));
  }
  account.Exported("sonar.range_min_m", "range/min");
  account.Exported("sonar.range_max_m", "range/max");
  account.Approximated("sonar.range_bins", "range/resolution",
                       "rays give ranges: binning them into an image is left to the user");
  const std::string elevation = fmt::format(
      "{} rays between hard edges, as far apart as the beams; ours falls to half power there", rows);
  AccountForElevation("scan/vertical", elevation, account);
  account.NotExpressed("material.", "Gazebo's lidar has ranges, and no echoes of materials");
  account.NotExpressed("absorption_db_per_m", "Gazebo's lidar has ranges, and no levels of echoes");
  account.NotExpressed("water.", "Gazebo's lidar has ranges, and no levels of echoes");
  AccountForTheRest("Gazebo", account);
  config.files.push_back(
      {"", XmlText(document, config.schema,
                   "Geometry alone: Gazebo itself has no imaging sonar. X looks ahead, Y to the left.\n"
                   "  The world needs the plugin gz-sim-sensors-system: see the world beside this file.",
                   account)});
  const pugi::xml_node model = document.document_element().child("model");
  for (ExportedFile& file : SdfWorld(model, source, name, config.schema, {}))
    config.files.push_back(std::move(file));
  return config;
}

}  // namespace sonarcal::exporting
