// Sonars by name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "data_io/types/sonar_model.h"

namespace sonarcal {

struct SonarPreset {
  std::string_view name;    // as on the command line
  std::string_view source;  // where the figures come from, and which of them are assumed
  SonarModel sonar;
  Water water;
};

const std::vector<SonarPreset>& SonarPresets();

// Throws UsageError that lists the names for an unknown one.
const SonarPreset& FindSonarPreset(std::string_view name);

}  // namespace sonarcal
