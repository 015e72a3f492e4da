// Sonars by name. Each has one mode of operation: its values, their source, and which of them are assumed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/types/sonar_model.h"

namespace sonarcal::sim {

// Meaning of a beam width as its source gives it. A SonarModel holds two-way widths.
enum class BeamWidthMeaning {
  // One-way width of the receiver. The transmitter covers the whole field of view, so the two-way width is
  // the same.
  kReceiver,
  kNotStated,  // taken as two-way
};

std::string_view Describe(BeamWidthMeaning meaning);

struct SonarPreset {
  std::string_view name;     // as on the command line
  std::string_view source;   // source of the values
  std::string_view assumed;  // values without a source
  BeamWidthMeaning azimuth_width = BeamWidthMeaning::kNotStated;
  BeamWidthMeaning elevation_width = BeamWidthMeaning::kNotStated;
  SonarModel sonar;
  Water water;
};

const std::vector<SonarPreset>& SonarPresets();

// "p900-45, didson-1.8, ...": all names.
std::string SonarPresetNames();

// Throws UsageError for an unknown name and lists the known ones.
const SonarPreset& FindSonarPreset(std::string_view name);

}  // namespace sonarcal::sim
