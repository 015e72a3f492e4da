// DAVE's multibeam sonar for ROS 2 and Gazebo Harmonic: a custom sensor of type "multibeam_sonar". Source:
// github.com/IOES-Lab/dave d655441, gazebo/dave_gz_multibeam_sonar/multibeam_sonar/MultibeamSonarSensor.cc
// (elements); 971108a for sonar_calculation_cuda.cu (the echo), models/dave_sensor_models/description/
// blueview_p900/model.sdf and models/dave_worlds/worlds/dave_multibeam_sonar.world (the plugin of the world).
//
// Rays go from min_angle to max_angle, both included. An even number of beams or rays is raised by one. The
// vertical rays cover twice the field of view that is written: each ray is taken for a cone as wide as that
// field. All surfaces have the reflectivity 0.001 with the square of cos(incidence).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <pugixml.hpp>

#include "apps/export/dave_echo.h"
#include "apps/export/even_fan.h"
#include "apps/export/export_words.h"
#include "apps/export/sdf_world.h"
#include "apps/export/simulator_configs.h"
#include "apps/export/xml_text.h"
#include "core/types/units.h"

namespace sonarcal::exporting {
namespace {

int Odd(int count) {
  return count % 2 == 0 ? count + 1 : count;
}

// The plugin doubles the vertical angles.
double HalfVerticalRad(const EvenFan& fan) {
  return RadFromDeg(0.25 * fan.elevation_deg);
}

void AddRays(pugi::xml_node sonar, const EvenFan& fan, const PolarAxes& axes, int rows) {
  pugi::xml_node ray = sonar.append_child("ray");
  ray.append_attribute("degrees") = "false";
  pugi::xml_node scan = ray.append_child("scan");
  pugi::xml_node horizontal = scan.append_child("horizontal");
  AddElement(horizontal, "beams", Odd(fan.beams));
  AddElement(horizontal, "min_angle", RadFromDeg(-fan.last_deg));
  AddElement(horizontal, "max_angle", RadFromDeg(-fan.first_deg));
  pugi::xml_node vertical = scan.append_child("vertical");
  AddElement(vertical, "rays", rows);
  AddElement(vertical, "min_angle", -HalfVerticalRad(fan));
  AddElement(vertical, "max_angle", HalfVerticalRad(fan));
  pugi::xml_node range = ray.append_child("range");
  AddElement(range, "min", std::max(axes.range_min_m, axes.range_bin_m()));
  AddElement(range, "max", axes.range_max_m);
}

void AddSpec(pugi::xml_node sonar, const ExportSource& source, const EvenFan& fan) {
  const SonarModel& model = source.sonar;
  pugi::xml_node spec = sonar.append_child("spec");
  AddElement(spec, "verticalFOV", fan.elevation_deg);
  AddElement(spec, "sonarFreq", model.frequency_hz);
  AddElement(spec, "bandwidth", model.sound_speed_m_per_s / (2.0 * model.axes.range_bin_m()));
  AddElement(spec, "soundSpeed", model.sound_speed_m_per_s);
  AddElement(spec, "maxDistance", model.axes.range_max_m);
  AddElement(spec, "sourceLevel", source.parameters.source_level_db);
  AddElement(spec, "raySkips", kDaveRaySkips);
}

void AccountForFan(const EvenFan& fan, int rows, ExportAccount& account) {
  const char* target = "scan/horizontal/beams, scan/horizontal/min_angle, scan/horizontal/max_angle";
  std::string how;
  if (fan.beams % 2 == 0) how += fmt::format("{} beams, as the plugin needs an odd number; ", Odd(fan.beams));
  if (!fan.IsEven())
    how += fmt::format("beams are spaced evenly, up to {:.3g} degrees off ours; ", fan.worst_deg);
  how += "beam 0 is the last";
  if (fan.beams % 2 != 0 && fan.IsEven()) {
    account.Exported("sonar.beam_azimuth_deg", target, how);
  } else {
    account.Approximated("sonar.beam_azimuth_deg", target, how);
  }
  AccountForElevation(
      "scan/vertical/rays, scan/vertical/max_angle, spec/verticalFOV",
      fmt::format(
          "{} rows of rays between hard edges; the angles are half of ours, because the plugin doubles "
          "them",
          rows),
      account);
}

}  // namespace

ExportedConfig ExportToDaveRos2(const ExportSource& source, const std::string& name) {
  const PolarAxes& axes = source.sonar.axes;
  const EvenFan fan = EvenFanOf(source);
  const int rows = Odd(std::max(3, static_cast<int>(std::lround(fan.elevation_deg / fan.spacing_deg()))));

  ExportedConfig config{.files = {},
                        .account = ExportAccount(source),
                        .schema = "DAVE for ROS 2 d655441 (multibeam_sonar), SDF 1.9"};
  pugi::xml_document document;
  pugi::xml_node sensor = AddSdfSensor(
      document,
      {.version = "1.9", .model = name, .link = "sonar_link", .name = "multibeam_sonar", .type = "custom"});
  document.document_element().append_attribute("xmlns:gz") = "http://gazebosim.org/schema";
  sensor.append_attribute("gz:type") = "multibeam_sonar";
  AddElement(sensor, "topic", "/sensor/multibeam_sonar");
  pugi::xml_node sonar = sensor.append_child("gz:multibeam_sonar");
  AddRays(sonar, fan, axes, rows);
  AddSpec(sonar, source, fan);

  ExportAccount& account = config.account;
  AccountForFan(fan, rows, account);
  account.Exported("sonar.frequency_hz", "spec/sonarFreq");
  account.Exported("sonar.sound_speed_m_per_s", "spec/soundSpeed");
  account.Exported("sonar.range_max_m", "spec/maxDistance, range/max");
  account.Approximated("sonar.range_min_m", "range/min",
                       "bins begin at range 0; what is nearer than the window is not seen");
  account.Approximated(
      "sonar.range_bins", "spec/bandwidth",
      fmt::format("bins are c / (2 bandwidth) = {:.6g} m long, as ours, and begin at range 0",
                  axes.range_bin_m()));
  account.Exported("source_level_db", "spec/sourceLevel",
                   "the plugin lets the area of a patch grow with range, not its square");
  account.NotExpressed("material.", "all surfaces have the reflectivity 0.001 in this version of DAVE");
  const std::string width = fmt::format(
      "a beam is as wide as its spacing, {:.4g} degrees, with DAVE's own pattern", fan.spacing_deg());
  account.Approximated("sonar.azimuth_beam_width_deg", "", width);
  account.Approximated("beam.azimuth_", "", width);
  AccountForDaveEcho(source, "spec/bandwidth", account);

  config.files.push_back(
      {"",
       XmlText(
           document, config.schema,
           "X looks ahead, Y to the left. The world needs the plugin multibeam_sonar_system of DAVE: see\n"
           "  the world beside this file.",
           account)});
  const pugi::xml_node model = document.document_element().child("model");
  const std::vector<WorldPlugin> plugins = {{"multibeam_sonar_system", "custom::MultibeamSonarSystem"}};
  for (ExportedFile& file : SdfWorld(model, source, name, config.schema, plugins))
    config.files.push_back(std::move(file));
  return config;
}

}  // namespace sonarcal::exporting
