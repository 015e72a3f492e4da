// Groups of poses at which a sonar stands still. A pose belongs to the first group whose first pose is the
// same (IsSamePose). So a sonar that moves slowly starts a new group after a millimetre or a milliradian. The
// time is linear in the number of poses.
#pragma once

#include <vector>

#include "core/types/pose.h"

namespace sonarcal {

// Indices of the poses of each group, in the order of their first pose.
std::vector<std::vector<int>> GroupByPose(const std::vector<Pose>& poses);

// Index of the first pose of the group of each pose.
std::vector<int> FirstOfPose(const std::vector<Pose>& poses);

}  // namespace sonarcal
