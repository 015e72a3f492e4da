// Limits of numbers in recording.json (docs/reference/recording.md). The geometry of a picture has the same
// ones, so that either file can hold what the other does. Readers of other formats leave out a value of a
// header that is beyond its limit, with a note, so that the recording can be converted.
#pragma once

#include "data_io/json/json_reader.h"

namespace sonarcal::data_io {

inline constexpr NumberRange kSonarFrequencyHz{.min = 0.0, .max = 1e9, .min_excluded = true};
inline constexpr NumberRange kSonarSoundSpeedMPerS{.min = 1000.0, .max = 2000.0};
inline constexpr NumberRange kSonarBeamWidthDeg{.min = 0.0, .max = 360.0};  // 0 = unknown
inline constexpr NumberRange kSonarRangeM{.min = 0.0, .max = 1e5};
inline constexpr NumberRange kRecordedLevelDb{.min = -1000.0, .max = 1000.0};  // levels and gains
inline constexpr NumberRange kRecordedSpanDb{.min = 0.0, .max = 1000.0, .min_excluded = true};
inline constexpr NumberRange kRecordedPulseUs{.min = 0.0, .max = 1e6, .min_excluded = true};
inline constexpr double kMaxRecordedFullScale = 1e12;

}  // namespace sonarcal::data_io
