// Other poses that a frame tells as well as the fitted one, the radiometry held.
//
// Two places are looked at. Along the direction that the frame tells least (a sonar that steps aside and
// turns keeps at its distance what lies at one distance): another valley is one where the quadratic about the
// fitted pose would have made the cost rise, and it did not. And at the sonar's reflection in the horizontal
// plane halfway up what it sees, with pitch and roll reversed: a sonar sees no elevation, so that what has
// such a plane of symmetry shows the same from both. What the prior of the poses rules out is not asked.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "calib/models/acoustic_frame_model.h"

namespace sonarcal::calib {

struct OtherPose {
  int frame = 0;                                // place among the model's frames
  std::vector<std::pair<int, double>> entries;  // those of the frame's pose, and their values there
  double worse_by = 0.0;  // nats, the prior included; negative: it explains the frame better
  std::string sentence;
};

// Those that fit worse by less than 4 nats (or better), about frames of which each component of the pose is
// free and no mount offset is; in the order of frames. `entries` are those of FreePoseEntries.
std::vector<OtherPose> OtherPoses(const AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
                                  const std::vector<int>& entries, const ParameterValues& values);

// Moves each frame to the best of its other poses where that explains it better by more than `by_nats`;
// returns how many moved.
int TakeBetterPoses(const std::vector<OtherPose>& others, double by_nats, ParameterValues& values);

// The reflected pose. `lowest_m` and `highest_m` bound the heights of what is seen.
Pose ReflectedPose(const Pose& world_from_sonar, double lowest_m, double highest_m);

}  // namespace sonarcal::calib
