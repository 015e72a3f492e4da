// Values that are assumed where neither a recording nor the parameters state them, as for a viewer's picture.
// Each command that assumes one says so.
#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>

#include "core/types/sonar_model.h"

namespace sonarcal::workflow {

inline constexpr double kAssumedFrequencyHz = 1e6;
inline constexpr double kAssumedAzimuthWidthDeg = 1.0;
inline constexpr double kAssumedElevationWidthDeg = 20.0;
inline constexpr double kAssumedSpanDb = 60.0;  // of the display

// Assumes a frequency if the sonar states none. Returns a sentence then.
inline std::optional<std::string> AssumeFrequency(SonarModel& sonar) {
  if (sonar.frequency_hz > 0.0) return std::nullopt;
  sonar.frequency_hz = kAssumedFrequencyHz;
  return fmt::format("the recording states no frequency: {:g} MHz is assumed for the absorption",
                     kAssumedFrequencyHz / 1e6);
}

}  // namespace sonarcal::workflow
