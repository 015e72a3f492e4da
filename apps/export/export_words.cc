#include "apps/export/export_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/types/units.h"
#include "sim/physics/receiver.h"

namespace sonarcal::exporting {

std::map<std::string, CosineLaw> FitCosineLaws(const ParameterSet& parameters, double exponent) {
  std::map<std::string, CosineLaw> laws;
  for (const auto& [name, material] : parameters.materials)
    laws[name] = FitCosineLaw(material.gsab, exponent);
  return laws;
}

std::map<std::string, double> RelativeReflectivities(const std::map<std::string, CosineLaw>& laws) {
  double strongest = 0.0;
  for (const auto& [name, law] : laws) strongest = std::max(strongest, law.coefficient);
  std::map<std::string, double> reflectivities;
  for (const auto& [name, law] : laws) reflectivities[name] = law.coefficient / strongest;
  return reflectivities;
}

void AccountForMaterials(const std::map<std::string, CosineLaw>& laws, const std::string& target,
                         const std::string& also, ExportAccount& account) {
  for (const auto& [name, law] : laws) {
    account.Approximated(
        fmt::format("material.{}.gsab.", name), fmt::format(fmt::runtime(target), name),
        fmt::format("the curve of '{}' by one number times cos^{:g} of the incidence, up to {:.1f} dB off "
                    "below {:g} degrees{}",
                    name, law.exponent, law.worst_db, kCosineLawMaxDeg, also));
  }
}

double SpeckleSpread(const ParameterSet& parameters) {
  return parameters.model == EchoModel::kPaper ? 0.0 : 1.0 / std::sqrt(parameters.receiver.looks);
}

double FloorOfFullScale(const ExportSource& source) {
  if (source.parameters.model == EchoModel::kPaper) return 0.0;
  const PolarAxes& axes = source.sonar.axes;
  sim::CheckTapers(source.parameters.receiver, axes.beam_count());
  double sum = 0.0;
  for (int beam = 0; beam < axes.beam_count(); ++beam) {
    sum += sim::NoisePower(source.parameters.receiver, axes.range_max_m, beam, source.absorption_db_per_m);
  }
  return sum / axes.beam_count() / PowerFromDb(source.parameters.display.db_max);
}

double RayleighOfFloor(const ExportSource& source) {
  return FloorOfFullScale(source) / std::sqrt(0.5 * kPi);
}

void AccountForElevation(const std::string& target, const std::string& how, ExportAccount& account) {
  account.Approximated("sonar.elevation_beam_width_deg", target, how);
  account.Approximated("beam.elevation_width_deg", target, how);
}

void AccountForFloor(const std::string& target, const std::string& how, ExportAccount& account) {
  account.Approximated("receiver.noise_db", target, how);
  account.Approximated("receiver.noise_after_gain_db", target, how);
}

void AccountForTheRest(const std::string& simulator, ExportAccount& account) {
  const auto no = [&](const char* name, const std::string& what) {
    account.NotExpressed(name, fmt::format("{} has no {}", simulator, what));
  };
  no("mirror.", "reflections by a mirror with a loss");
  no("receiver.time_varied_gain", "gain that grows with range");
  no("receiver.gain_db", "gain of the receiver in dB");
  no("receiver.noise_taper_db", "noise that differs by beam");
  no("receiver.noise_after_gain_taper_db", "noise that differs by beam");
  no("receiver.noise_slope_db_per_m", "noise that changes with range as ours");
  no("receiver.noise_", "floor of noise");
  no("receiver.looks", "number of looks");
  no("receiver.diffuse_share", "texture of reverberation");
  no("beam.azimuth_", "shape of the beams in azimuth");
  no("beam.elevation_width_deg", "width of the beams in elevation of the parameters' own");
  no("beam.elevation_", "shape of the beams in elevation: it ends at a hard edge");
  no("beam.transmit_", "sound sent beyond the field of view");
  no("beam.mirror_lobes", "choice of the lobes through which mirrors are seen");
  no("beam.sensitivity_db", "sensitivity that differs by beam");
  no("pulse.", "length of the pulse");
  no("jitter.", "errors of a ray in range and azimuth");
  no("display.", "display in dB: its values are linear");
  no("sonar.azimuth_beam_width_deg", "width of one beam: beams are as wide as their spacing");
  no("sonar.pings.", "pings that receive a part of the beams each");
  no("sonar.beam_forming", "receiver noise that neighbouring beams share");
  no("sonar.frequency_hz", "frequency");
  no("sonar.sound_speed_m_per_s", "speed of sound");
  no("source_level_db", "source level");
  no("noise_level_db", "noise level");
  no("array_gain_db", "array gain");
  no("absorption_db_per_m", "absorption that can be set");
  no("water.", "water of its own: temperature, salinity, acidity and depth act through absorption alone");
  account.NotExpressed("model", fmt::format("{} has an echo model of its own", simulator));
}

}  // namespace sonarcal::exporting
