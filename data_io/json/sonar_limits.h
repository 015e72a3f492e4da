// Limits of the properties of a sonar that both recording.json and the geometry of a picture state, so that
// either file can hold what the other does.
#pragma once

#include "data_io/json/json_reader.h"

namespace sonarcal::data_io {

inline constexpr NumberRange kSonarFrequencyHz{.min = 0.0, .max = 1e9, .min_excluded = true};
inline constexpr NumberRange kSonarSoundSpeedMPerS{.min = 1000.0, .max = 2000.0};
inline constexpr NumberRange kSonarBeamWidthDeg{.min = 0.0, .max = 360.0};  // 0 = unknown
inline constexpr NumberRange kSonarRangeM{.min = 0.0, .max = 1e5};

}  // namespace sonarcal::data_io
