#include "apps/workflow/known_truth.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "calib/parameters/parameter_catalog.h"
#include "data_io/json/json_reader.h"
#include "data_io/parameters/parameters_io.h"
#include "sim/physics/gsab.h"
#include "sim/physics/paper_echo.h"

namespace sonarcal::workflow {
namespace {

namespace fs = std::filesystem;

// Levels that differ by less than this are equal, dB.
constexpr double kSameLevelDb = 1e-6;

ParameterSet FromTruthFile(const fs::path& file) {
  const data_io::JsonReader root = data_io::JsonReader::FromFile(file);
  ParameterSet truth;
  truth.model = EchoModel::kCoherent;
  truth.source_level_db = root.At("source_level_db").Number();
  for (const auto& [name, curve] : root.At("gsab").Members()) {
    truth.materials[name].gsab = {.a = curve.At("A").Number(),
                                  .b_deg = curve.At("B").Number(),
                                  .c = curve.At("C").Number(),
                                  .d = curve.At("D").Number(),
                                  .e = curve.At("E").Number(),
                                  .f_deg = curve.At("F").Number()};
  }
  if (const auto noise = root.Find("noise_level_db")) truth.receiver.noise_db = noise->Number();
  if (const auto cell = root.Find("cell")) {
    truth.beam.azimuth_width_deg = cell->At("azimuth_half_power_deg_at_centre").Number();
    truth.beam.elevation_width_deg = cell->At("elevation_half_power_deg").Number();
    truth.pulse.length_m = cell->At("range_half_power_m").Number();
  }
  if (const auto reflection = root.Find("reflection_pressure"); reflection && reflection->is_object()) {
    for (const auto& [name, pressure] : reflection->Members())
      truth.mirrors[name].loss_db = -20.0 * std::log10(std::abs(pressure.Number()));
  }
  return truth;
}

// Materials of `scene` that `truth` gives values for.
std::vector<std::string> KnownMaterials(const ParameterSet& truth, const Scene& scene) {
  std::vector<std::string> names;
  for (const std::string& name : scene.material_names) {
    if (truth.materials.contains(name) || truth.materials.contains("default")) names.push_back(name);
  }
  return names;
}

struct NamedValue {
  std::string name;
  double value = 0.0;
};

std::vector<NamedValue> PaperValues(const ParameterSet& truth, const std::vector<std::string>& materials) {
  sim::PaperParameters<double> parameters = sim::PaperParametersFor(truth, materials);
  std::vector<NamedValue> values;
  for (const calib::CatalogEntry& entry : calib::BuildCatalog(materials))
    values.push_back({entry.name, calib::PaperSlot(parameters, entry)});
  return values;
}

std::vector<NamedValue> AcousticValues(ParameterSet truth, const std::vector<std::string>& materials,
                                       const SonarModel& sonar) {
  for (const std::string& name : materials) truth.materials[name] = truth.Material(name);
  const bool has_noise = truth.receiver.noise_db.has_value();
  if (!has_noise) truth.receiver.noise_db = 0.0;
  // A width of 0 stands for that of the sonar.
  const auto resolve = [](double& width, double own) {
    if (!(width > 0.0)) width = own;
  };
  resolve(truth.beam.azimuth_width_deg, sonar.azimuth_beam_width_deg);
  resolve(truth.beam.elevation_width_deg, sonar.elevation_beam_width_deg);
  resolve(truth.pulse.length_m, sonar.axes.range_bin_m());
  std::vector<char> mirrors;
  for (const std::string& name : materials) mirrors.push_back(truth.mirrors.contains(name) ? 1 : 0);
  std::vector<NamedValue> values;
  for (const calib::CatalogEntry& entry : calib::BuildAcousticCatalog(materials, sonar, {}, mirrors)) {
    if (calib::IsPlacement(entry)) continue;
    if (entry.group == calib::ParameterGroup::kReceiver && entry.index > 0 && !has_noise) continue;
    if (entry.group == calib::ParameterGroup::kTransmit && !(truth.beam.transmit_end_deg > 0.0)) continue;
    values.push_back({entry.name, calib::AcousticSlot(truth, materials, entry)});
  }
  return values;
}

// Tests whether an echo of the same curve has the same level, so that A, C and E mean the same.
bool SameLevels(const ParameterSet& truth, const ParameterSet& fitted) {
  const auto level_db = [](const ParameterSet& p) {
    return p.model == EchoModel::kPaper ? p.source_level_db - p.display.db_min
                                        : p.source_level_db + p.receiver.gain_db;
  };
  return std::abs(level_db(truth) - level_db(fitted)) < kSameLevelDb;
}

bool IsAmplitude(const std::string& name) {
  return name.starts_with("material.") &&
         (name.ends_with(".gsab.A") || name.ends_with(".gsab.C") || name.ends_with(".gsab.E"));
}

}  // namespace

std::optional<ParameterSet> ReadTruth(const RecordingInfo& info) {
  const fs::path recording = info.source;
  if (const fs::path file = recording / "truth.json"; fs::is_regular_file(file)) return FromTruthFile(file);
  if (const fs::path file = recording / "params.json"; info.synthetic && fs::is_regular_file(file))
    return data_io::ReadParameters(file);
  return std::nullopt;
}

void AddTruth(const ParameterSet& truth, const ParameterSet& fitted, const Scene& scene,
              const SonarModel& sonar, calib::FitReport& report) {
  const bool paper = fitted.model == EchoModel::kPaper;
  if (paper != (truth.model == EchoModel::kPaper)) return;
  const std::vector<std::string> materials = KnownMaterials(truth, scene);
  const bool same_levels = SameLevels(truth, fitted);
  for (const NamedValue& of :
       paper ? PaperValues(truth, materials) : AcousticValues(truth, materials, sonar)) {
    if (IsAmplitude(of.name) && !same_levels) continue;
    for (calib::FittedParameter& parameter : report.parameters) {
      if (parameter.name == of.name) parameter.truth = of.value;
    }
  }
  for (calib::FittedCurve& curve : report.curves) {
    curve.truth_db.clear();
    if (!same_levels || std::find(materials.begin(), materials.end(), curve.material) == materials.end())
      continue;
    for (const double incidence_deg : curve.incidence_deg)
      curve.truth_db.push_back(sim::GsabDb(truth.Material(curve.material).gsab, incidence_deg));
  }
}

}  // namespace sonarcal::workflow
