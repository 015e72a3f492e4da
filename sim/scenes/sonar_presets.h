// Sonars by name. Each has one mode of operation: its figures, where they come from, and which are assumed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/types/sonar_model.h"

namespace sonarcal::sim {

// Meaning of a beam width as its source gives it. A SonarModel holds two-way widths.
enum class BeamWidthMeaning {
  // One-way, of the receiver. The transmitter covers the whole field of view, so that the two-way width is
  // the same.
  kReceiver,
  kNotStated,  // taken as two-way
};

std::string_view Describe(BeamWidthMeaning meaning);

struct SonarPreset {
  std::string_view name;     // as on the command line
  std::string_view source;   // where the figures come from
  std::string_view assumed;  // the figures that no source gives
  BeamWidthMeaning azimuth_width = BeamWidthMeaning::kNotStated;
  BeamWidthMeaning elevation_width = BeamWidthMeaning::kNotStated;
  SonarModel sonar;
  Water water;
};

const std::vector<SonarPreset>& SonarPresets();

// "p900-45, didson-1.8, ...": all names.
std::string SonarPresetNames();

// Throws UsageError that lists the names for an unknown one.
const SonarPreset& FindSonarPreset(std::string_view name);

}  // namespace sonarcal::sim
