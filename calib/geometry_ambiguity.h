// Other explanations of the fitted geometry of a sonar: a data sheet that is wrong looks like a scene, a
// mount or a position that is wrong.
#pragma once

#include <string>
#include <vector>

#include "calib/fit_report.h"

namespace sonarcal::calib {

// Returns a sentence for each free value of the geometry that has another explanation.
std::vector<std::string> GeometryAmbiguities(const FitReport& report, int distinct_poses);

}  // namespace sonarcal::calib
