#include "calib/standard_target/display_slope.h"

#include <cmath>

#include "core/types/error.h"

namespace sonarcal::calib {

DisplaySlope SlopeOfTwoTargets(const TargetLevel& one, const TargetLevel& other) {
  constexpr double kLeastDifferenceDb = 3.0;
  const double shown_db = one.received_db - other.received_db;
  if (!(std::abs(shown_db) >= kLeastDifferenceDb)) {
    throw DataError(
        "the two targets are shown {:.1f} dB apart, expected {:.0f} dB or more for the slope of the "
        "display",
        std::abs(shown_db), kLeastDifferenceDb);
  }
  const DisplaySlope slope{
      .db_per_shown_db = 1.0 - (one.level_db - other.level_db) / shown_db,
      .sigma = std::hypot(one.level_sigma_db, other.level_sigma_db) / std::abs(shown_db)};
  if (!(slope.db_per_shown_db > 0.0))
    throw DataError("the weaker of the two targets is shown as the stronger: were the settings the same?");
  return slope;
}

}  // namespace sonarcal::calib
