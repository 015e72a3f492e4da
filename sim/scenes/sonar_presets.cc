#include "sim/scenes/sonar_presets.h"

#include <fmt/format.h>

#include <utility>

#include "core/sonars/aris_beam_tables.h"
#include "core/text/nearest_word.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/absorption.h"

namespace sonarcal::sim {
namespace {

constexpr Water kFreshWater = {.temperature_c = 15.0, .salinity_ppt = 0.0, .ph = 7.0, .depth_m = 1.0};

// Evenly spaced beams, centred on broadside.
std::vector<double> EvenBeamsRad(int count, double spacing_deg) {
  std::vector<double> azimuth_rad;
  for (int beam = 0; beam < count; ++beam)
    azimuth_rad.push_back(RadFromDeg((beam - 0.5 * (count - 1)) * spacing_deg));
  return azimuth_rad;
}

SonarPreset P900() {
  const Water water{.temperature_c = 15.0, .salinity_ppt = 0.5, .ph = 7.0, .depth_m = 1.0};
  return {.name = "p900-45",
          .source = "Park 2024, Tables 4 and 5",
          .assumed = "330 range bins, of the 2.54 cm range resolution",
          .azimuth_width = BeamWidthMeaning::kReceiver,
          .sonar = {.name = "P900-45",
                    .frequency_hz = 900e3,
                    .axes = {0.62, 9.0, 330, EvenBeamsRad(256, 0.18)},
                    .azimuth_beam_width_deg = 1.0,
                    .elevation_beam_width_deg = 20.0,
                    .sound_speed_m_per_s = BilaniukWongSoundSpeed(water.temperature_c),
                    .beam_forming = BeamForming::kArray},
          .water = water};
}

SonarPreset Didson(std::string_view name, double frequency_hz, int beams, double spacing_deg,
                   double width_deg) {
  return {
      .name = name,
      .source =
          "beams: Sound Metrics, SONAR 101, \"DIDSON Resolution\"; field of view: BCO-DMO instrument page "
          "\"DIDSON 3000m\"; 512 samples: public recordings",
      .assumed = "range window (that of public pings of a hull), fresh water of 15 C",
      .sonar = {.name = fmt::format("DIDSON, {:g} MHz", 1e-6 * frequency_hz),
                .frequency_hz = frequency_hz,
                .axes = {2.25, 11.25, 512, EvenBeamsRad(beams, spacing_deg)},
                .azimuth_beam_width_deg = width_deg,
                .elevation_beam_width_deg = 14.0,
                .sound_speed_m_per_s = BilaniukWongSoundSpeed(kFreshWater.temperature_c),
                .beam_forming = BeamForming::kLens},
      .water = kFreshWater};
}

struct RangeWindow {
  double min_m;
  double max_m;
  int bins;
};

// Window of the published ARIS 3000 frames of dfki-ric/uxo-dataset2024.
constexpr RangeWindow kAris3000Window = {0.690, 2.998, 780};

// Without a width, the beam width is the beam spacing.
SonarPreset Aris(std::string_view name, int model, ArisSystem system, double frequency_hz, int beams,
                 const RangeWindow& window, std::string_view assumed, double width_deg = 0.0) {
  const auto centres_deg = ArisBeamCentresDeg(system, beams, ArisLens::kStandard);
  PolarAxes axes{window.min_m, window.max_m, window.bins, ArisAzimuthsRad(centres_deg)};
  const double spacing_deg = DegFromRad(axes.beam_spacing_rad());
  return {.name = name,
          .source =
              "beams: the manufacturer's table in the ARIS File SDK; field of view: the manufacturer's "
              "nominal one",
          .assumed = assumed,
          .sonar = {.name = fmt::format("ARIS Explorer {}, {:.1f} MHz", model, 1e-6 * frequency_hz),
                    .frequency_hz = frequency_hz,
                    .axes = std::move(axes),
                    .azimuth_beam_width_deg = width_deg > 0.0 ? width_deg : spacing_deg,
                    .elevation_beam_width_deg = system == ArisSystem::kAris3000 ? 15.0 : 14.0,
                    .sound_speed_m_per_s = BilaniukWongSoundSpeed(kFreshWater.temperature_c),
                    .beam_forming = BeamForming::kLens},
          .water = kFreshWater};
}

// Field of view, widths and range resolution of a multibeam sonar with a line array.
struct ArrayMode {
  double frequency_hz;
  double field_deg;
  double width_deg;
  double elevation_deg;
  double range_resolution_m;
};

SonarPreset ArraySonar(std::string_view name, std::string sonar_name, const ArrayMode& mode,
                       std::string_view source, std::string_view assumed) {
  constexpr int kBeams = 512;
  constexpr int kBins = 2000;
  constexpr double kNearestM = 0.1;
  return {.name = name,
          .source = source,
          .assumed = assumed,
          .azimuth_width = BeamWidthMeaning::kReceiver,
          .sonar = {.name = std::move(sonar_name),
                    .frequency_hz = mode.frequency_hz,
                    .axes = {kNearestM, kNearestM + kBins * mode.range_resolution_m, kBins,
                             EvenBeamsRad(kBeams, mode.field_deg / kBeams)},
                    .azimuth_beam_width_deg = mode.width_deg,
                    .elevation_beam_width_deg = mode.elevation_deg,
                    .sound_speed_m_per_s = BilaniukWongSoundSpeed(kFreshWater.temperature_c),
                    .beam_forming = BeamForming::kArray},
          .water = kFreshWater};
}

SonarPreset Oculus(std::string_view name, std::string_view model, const ArrayMode& mode) {
  return ArraySonar(
      name, fmt::format("Oculus {}, {:g} MHz", model, 1e-6 * mode.frequency_hz), mode,
      "Blueprint Subsea, data sheets of the Oculus M series",
      "beams evenly spaced, range window (2000 bins of the best resolution), fresh water of 15 C");
}

std::vector<SonarPreset> AllPresets() {
  constexpr std::string_view kArisAssumed =
      "beam width (the spacing of the beams), range window and bins, fresh water of 15 C";
  constexpr RangeWindow kAris1800Window = {1.0, 6.0, 1000};
  constexpr RangeWindow kAris1200Window = {2.0, 20.0, 1000};
  return {
      P900(),
      Didson("didson-1.8", 1.8e6, 96, 0.3, 0.3),
      Didson("didson-1.1", 1.1e6, 48, 0.6, 0.4),
      Aris("aris1200-1.2", 1200, ArisSystem::kAris1200, 1.2e6, 48, kAris1200Window, kArisAssumed),
      Aris("aris1200-0.7", 1200, ArisSystem::kAris1200, 0.7e6, 48, kAris1200Window, kArisAssumed),
      Aris("aris1800-1.8", 1800, ArisSystem::kAris1800, 1.8e6, 96, kAris1800Window, kArisAssumed),
      Aris("aris1800-1.1", 1800, ArisSystem::kAris1800, 1.1e6, 48, kAris1800Window, kArisAssumed),
      Aris("aris3000", 3000, ArisSystem::kAris3000, 3.0e6, 128, kAris3000Window,
           "beam width, range window and bins (inferred from frames of the DFKI UXO data set), fresh water "
           "of 15 C",
           0.25),
      Aris("aris3000-1.8", 3000, ArisSystem::kAris3000, 1.8e6, 64, kAris3000Window, kArisAssumed),
      Oculus("oculus-m750d-0.75", "M750d", {0.75e6, 130.0, 1.0, 20.0, 4e-3}),
      Oculus("oculus-m750d-1.2", "M750d", {1.2e6, 130.0, 0.6, 20.0, 2.5e-3}),
      Oculus("oculus-m1200d-1.2", "M1200d", {1.2e6, 130.0, 0.6, 20.0, 2.5e-3}),
      Oculus("oculus-m1200d-2.1", "M1200d", {2.1e6, 60.0, 0.4, 12.0, 2.5e-3}),
      Oculus("oculus-m3000d-1.2", "M3000d", {1.2e6, 130.0, 0.6, 20.0, 2.5e-3}),
      Oculus("oculus-m3000d-3.0", "M3000d", {3.0e6, 40.0, 0.25, 20.0, 2e-3}),
      ArraySonar("gemini-720is", "Gemini 720is", {0.72e6, 120.0, 1.0, 20.0, 4e-3},
                 "Tritech, Gemini 720is product manual 0703-SOM-00002 (frequency, field of view, widths); "
                 "Tritech, data sheet 0703-SOM-00001 (512 beams, range resolution)",
                 "beams evenly spaced, range window (2000 bins of the best resolution), fresh water of 15 C"),
  };
}

}  // namespace

std::string_view Describe(BeamWidthMeaning meaning) {
  switch (meaning) {
    case BeamWidthMeaning::kReceiver:
      return "one-way, of the receiver, and two-way as well: the transmitter covers the field of view";
    case BeamWidthMeaning::kNotStated:
      break;
  }
  return "not stated whether one-way or two-way; assumed two-way";
}

const std::vector<SonarPreset>& SonarPresets() {
  static const std::vector<SonarPreset> kPresets = AllPresets();
  return kPresets;
}

std::string SonarPresetNames() {
  std::string names;
  for (const SonarPreset& preset : SonarPresets())
    names += fmt::format("{}{}", names.empty() ? "" : ", ", preset.name);
  return names;
}

const SonarPreset& FindSonarPreset(std::string_view name) {
  for (const SonarPreset& preset : SonarPresets()) {
    if (preset.name == name) return preset;
  }
  std::vector<std::string> names;
  for (const SonarPreset& preset : SonarPresets()) names.emplace_back(preset.name);
  throw UsageError("unknown sonar '{}'{}", name,
                   ExpectedWord(name, names, fmt::format("one of {}, or a file", SonarPresetNames())));
}

}  // namespace sonarcal::sim
