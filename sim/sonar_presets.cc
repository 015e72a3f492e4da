#include "sim/sonar_presets.h"

#include <fmt/format.h>

#include "data_io/aris_beam_tables.h"
#include "data_io/types/error.h"
#include "data_io/types/units.h"
#include "sim/physics/absorption.h"

namespace sonarcal {
namespace {

// Beams of equal spacing, centred on the bore-sight.
std::vector<double> EvenBeamsRad(int count, double spacing_deg) {
  std::vector<double> azimuth_rad;
  for (int beam = 0; beam < count; ++beam)
    azimuth_rad.push_back(RadFromDeg((beam - 0.5 * (count - 1)) * spacing_deg));
  return azimuth_rad;
}

SonarPreset P900() {
  const Water water{.temperature_c = 15.0, .salinity_ppt = 0.5, .ph = 7.0, .depth_m = 1.0};
  return {.name = "p900-45",
          .source =
              "Teledyne BlueView P900-45 as in Park 2024 Tables 4 and 5; 330 bins of its 2.54 cm range "
              "resolution",
          .sonar = {.name = "P900-45",
                    .frequency_hz = 900e3,
                    .axes = {0.62, 9.0, 330, EvenBeamsRad(256, 0.18)},
                    .azimuth_beam_width_deg = 1.0,
                    .elevation_beam_width_deg = 20.0,
                    .sound_speed_m_per_s = BilaniukWongSoundSpeed(water.temperature_c)},
          .water = water};
}

// The window is that of the recorded frames of data_io/aris3000_frames_io.h.
SonarPreset Aris3000() {
  const Water water{.temperature_c = 15.0, .salinity_ppt = 0.0, .ph = 7.0, .depth_m = 1.0};
  const auto centres_deg = ArisBeamCentresDeg(ArisSystem::kAris3000, 128, ArisLens::kStandard);
  return {.name = "aris3000",
          .source =
              "Sound Metrics ARIS Explorer 3000 at 3.0 MHz, 30 x 15 degrees, 128 beams of the maker's table; "
              "range window and bins inferred from frames of the DFKI UXO data set; assumed: beam width "
              "0.25 degrees, fresh water of 15 C",
          .sonar = {.name = "ARIS Explorer 3000",
                    .frequency_hz = 3.0e6,
                    .axes = {0.690, 2.998, 780, ArisAzimuthsRad(centres_deg)},
                    .azimuth_beam_width_deg = 0.25,
                    .elevation_beam_width_deg = 15.0,
                    .sound_speed_m_per_s = BilaniukWongSoundSpeed(water.temperature_c)},
          .water = water};
}

}  // namespace

const std::vector<SonarPreset>& SonarPresets() {
  static const std::vector<SonarPreset> presets = {P900(), Aris3000()};
  return presets;
}

const SonarPreset& FindSonarPreset(std::string_view name) {
  std::string names;
  for (const SonarPreset& preset : SonarPresets()) {
    if (preset.name == name) return preset;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", preset.name);
  }
  throw UsageError("unknown sonar '{}'; expected one of {}, or a file", name, names);
}

}  // namespace sonarcal
