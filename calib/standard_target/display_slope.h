// Slope of a display, from two targets of different strength that one sonar recorded with the same settings.
#pragma once

#include <cmath>

namespace sonarcal::calib {

// Result of the fit of one target.
struct TargetLevel {
  double level_db = 0.0;        // source level plus gain
  double level_sigma_db = 0.0;  // with that of the target's strength
  double received_db = 0.0;     // level at which the target is shown
};

struct DisplaySlope {
  double db_per_shown_db = 1.0;  // factor for the span of the display
  double sigma = 0.0;

  // Whether a display that is true is within two standard errors.
  bool AgreesWithDisplay() const { return std::abs(db_per_shown_db - 1.0) <= 2.0 * sigma; }
};

// If the display is true, both targets give the same source level plus gain. If its span must be multiplied
// by a factor k, the two differ by 1 - k times the difference of the shown levels. Takes the errors of both
// levels as independent. Throws DataError if the shown levels differ by less than 3 dB, or if the weaker
// target is shown as the stronger.
DisplaySlope SlopeOfTwoTargets(const TargetLevel& one, const TargetLevel& other);

}  // namespace sonarcal::calib
