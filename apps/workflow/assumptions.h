// Values that are assumed where neither a recording nor the parameters state them, as for a viewer's picture.
// Each command that assumes one says so.
#pragma once

namespace sonarcal::workflow {

inline constexpr double kAssumedFrequencyHz = 1e6;
inline constexpr double kAssumedAzimuthWidthDeg = 1.0;
inline constexpr double kAssumedElevationWidthDeg = 20.0;
inline constexpr double kAssumedSpanDb = 60.0;  // of the display

}  // namespace sonarcal::workflow
