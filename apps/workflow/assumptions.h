// Values that are assumed where neither a recording nor the parameters state them, as for a viewer's picture.
// Each command that assumes one says so.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/image.h"
#include "core/types/parameters.h"
#include "core/types/sonar_model.h"

namespace sonarcal::workflow {

inline constexpr double kAssumedFrequencyHz = 1e6;
inline constexpr double kAssumedAzimuthWidthDeg = 1.0;
inline constexpr double kAssumedElevationWidthDeg = 20.0;
inline constexpr double kAssumedSpanDb = 60.0;  // of the display

// Assumes a frequency if the sonar states none. Returns a sentence then.
std::optional<std::string> AssumeFrequency(SonarModel& sonar);

// Assumes the widths that neither the sonar nor `beam` states, and returns them.
struct AssumedWidth {
  std::string_view name;  // of the parameter
  double deg = 0.0;
};
std::vector<AssumedWidth> AssumeWidths(const SonarModel& sonar, BeamParameters& beam);

// Assumes what neither the sonar of a recording nor the parameters state. Returns a sentence for each.
// `find_display`: the caller finds the display, so that none is assumed.
std::vector<std::string> AssumeMissing(const ImageScale& scale, bool find_display, SonarModel& sonar,
                                       ParameterSet& parameters);

}  // namespace sonarcal::workflow
