// OceanSim's ImagingSonarSensor, which is configured by arguments in Python. Source:
// github.com/umfieldrobotics/OceanSim 2809388: isaacsim/oceansim/sensors/ImagingSonarSensor.py,
// utils/ImagingSonar_kernels.py, docs/subsections/running_example.md.
//
// A value there is reflectivity cos(incidence) exp(-attenuation range), summed over the points of a bin. It
// is divided by the maximum of the image (by default by that of each range, which makes ranges incomparable),
// multiplied by 0.5 + normal noise, plus Rayleigh noise that grows with the square of range.
#include <fmt/format.h>

#include <cctype>
#include <cmath>

#include "apps/export/even_fan.h"
#include "apps/export/export_words.h"
#include "apps/export/simulator_configs.h"
#include "core/types/units.h"
#include "data_io/json/json_writer.h"

namespace sonarcal::exporting {
namespace {

// Path of the camera in the stage. USD allows letters, digits and '_', and no digit in front.
std::string PrimPath(const std::string& name) {
  std::string path = "/World/sonar_" + name;
  for (std::size_t i = sizeof("/World/") - 1; i < path.size(); ++i) {
    if (std::isalnum(static_cast<unsigned char>(path[i])) == 0) path[i] = '_';
  }
  return path;
}

}  // namespace

ExportedConfig ExportToOceanSim(const ExportSource& source, const std::string& name) {
  const ParameterSet& parameters = source.parameters;
  const PolarAxes& axes = source.sonar.axes;
  const EvenFan fan = EvenFanOf(source);
  const auto laws = FitCosineLaws(parameters, 1.0);
  constexpr double kMeanFactor = 0.5;

  const nlohmann::ordered_json arguments = {{"ImagingSonarSensor",
                                             {{"prim_path", PrimPath(name)},
                                              {"name", name},
                                              {"min_range", axes.range_min_m},
                                              {"max_range", axes.range_max_m},
                                              {"range_res", axes.range_bin_m()},
                                              {"hori_fov", fan.field_deg},
                                              {"vert_fov", fan.elevation_deg},
                                              {"angular_res", fan.spacing_deg()}}},
                                            {"sonar_initialize", {{"normalizing_method", "all"}}},
                                            {"make_sonar_data",
                                             {{"attenuation", 2.0 * source.absorption_db_per_m * kNeperPerDb},
                                              {"gau_noise_param", kMeanFactor * SpeckleSpread(parameters)},
                                              {"ray_noise_param", RayleighOfFloor(source)},
                                              {"central_peak", 0.0}}},
                                            {"reflectivity", RelativeReflectivities(laws)}};

  ExportedConfig config{.files = {{"", data_io::JsonText(arguments)}},
                        .account = ExportAccount(source),
                        .schema = "OceanSim 2809388, ImagingSonarSensor"};
  ExportAccount& account = config.account;
  AccountForBeams(fan, "hori_fov, angular_res", account);
  account.Exported("sonar.range_min_m", "min_range");
  account.Exported("sonar.range_max_m", "max_range");
  account.Exported("sonar.range_bins", "range_res");
  AccountForElevation("vert_fov", kHardEdge, account);
  AccountForMaterials(laws, "reflectivity/{}",
                      "; relative to the strongest material, as OceanSim divides by the brightest pixel",
                      account);
  account.Approximated("receiver.looks", "gau_noise_param",
                       "speckle by a normal factor of the same relative spread, 1 / sqrt(looks)");
  AccountForFloor("ray_noise_param",
                  "the floor at the far end of the window, relative to full scale, as the mean of a Rayleigh "
                  "law that grows with the square of range",
                  account);
  const std::string absorption =
      "absorption on both ways as an exponential of range; spreading has no counterpart";
  account.Approximated("absorption_db_per_m", "attenuation", absorption);
  account.Approximated("water.", "attenuation", absorption);
  AccountForTheRest("OceanSim", account);
  return config;
}

}  // namespace sonarcal::exporting
