// HoloOcean's ImagingSonar: an entry of "sensors" in a scenario. Source: client/src/holoocean/sensors.py (the
// docstring of ImagingSonar lists all keys) and byu-holoocean.github.io/holoocean-docs,
// sensors/docs/sensor-config. engine/Source/Holodeck/Sensors/Private/ImagingSonar.cpp reads the keys
// (github.com/wellscrosby/MRGHoloOcean ba96e3e, a public copy). Intensities there have no unit; we use 1 for
// the power at full scale.
#include <fmt/format.h>

#include "apps/export/even_fan.h"
#include "apps/export/export_words.h"
#include "apps/export/simulator_configs.h"
#include "data_io/json/json_writer.h"

namespace sonarcal::exporting {
namespace {

constexpr double kMeanFactor = 0.5;  // HoloOcean multiplies by 0.5 plus normal noise

}  // namespace

ExportedConfig ExportToHoloOcean(const ExportSource& source, const std::string& name) {
  const ParameterSet& parameters = source.parameters;
  const PolarAxes& axes = source.sonar.axes;
  const EvenFan fan = EvenFanOf(source);
  const bool is_paper = parameters.model == EchoModel::kPaper;
  const bool has_mirrors = !is_paper && !parameters.mirrors.empty();

  nlohmann::ordered_json configuration = {{"Azimuth", fan.field_deg},
                                          {"Elevation", fan.elevation_deg},
                                          {"RangeMin", axes.range_min_m},
                                          {"RangeMax", axes.range_max_m},
                                          {"RangeBins", axes.range_bins},
                                          {"AzimuthBins", fan.beams},
                                          {"AddSigma", RayleighOfFloor(source)},
                                          {"MultSigma", kMeanFactor * SpeckleSpread(parameters)},
                                          {"MultiPath", has_mirrors},
                                          {"WaterSpeedSound", source.sonar.sound_speed_m_per_s}};
  if (is_paper) configuration["RangeSigma"] = parameters.jitter.sigma_range_m;
  const nlohmann::ordered_json sensor = {
      {"sensor_type", "ImagingSonar"}, {"sensor_name", name}, {"configuration", configuration}};

  ExportedConfig config{.files = {{"", data_io::JsonText(sensor)}},
                        .account = ExportAccount(source),
                        .schema = "HoloOcean 2, ImagingSonar"};
  ExportAccount& account = config.account;
  AccountForBeams(fan, "Azimuth, AzimuthBins", account);
  account.Exported("sonar.range_min_m", "RangeMin");
  account.Exported("sonar.range_max_m", "RangeMax");
  account.Exported("sonar.range_bins", "RangeBins");
  account.Exported("sonar.sound_speed_m_per_s", "WaterSpeedSound");
  AccountForElevation("Elevation", kHardEdge, account);
  account.Approximated("receiver.looks", "MultSigma",
                       "speckle by a normal factor of the same relative spread, 1 / sqrt(looks)");
  AccountForFloor("AddSigma",
                  "the floor at the far end of the window, relative to full scale, as the mean of a Rayleigh "
                  "law; it does not change with range",
                  account);
  account.Approximated("jitter.sigma_range_m", "RangeSigma",
                       "an exponential error in place of a normal one, not growing with range");
  account.Approximated("mirror.", "MultiPath", "one bounce by the impedances of HoloOcean's materials");
  account.NotExpressed(
      "material.",
      "HoloOcean reflects by density and speed of sound of its own materials (materials.csv), "
      "which a curve of backscatter does not tell");
  AccountForTheRest("HoloOcean", account);
  return config;
}

}  // namespace sonarcal::exporting
