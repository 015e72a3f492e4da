// Limits of numbers in recording.json (docs/reference/recording.md); data_io/json/sonar_limits.h has those of
// the sonar. Readers of other formats leave out a value of a header that is beyond its limit, with a note, so
// that every recording can be converted.
#pragma once

namespace sonarcal::data_io {

inline constexpr double kMaxRecordedLevelDb = 1000.0;  // absolute value of levels and gains
inline constexpr double kMaxRecordedDbSpan = 1000.0;
inline constexpr double kMaxRecordedPulseUs = 1e6;
inline constexpr double kMaxRecordedFullScale = 1e12;

}  // namespace sonarcal::data_io
