// Finds other poses that match a frame as well as the fitted one, with the radiometry fixed.
//
// Two searches are made. First along the direction that the frame determines least, such as a step aside with
// a turn, which keeps distances. There is another valley if the cost does not rise as the quadratic about the
// fitted pose predicts. Second at the reflection of the sonar in the horizontal plane halfway up the visible
// surfaces, with pitch and roll reversed. A sonar does not measure elevation, so a scene that is symmetric in
// such a plane looks the same from both poses. Poses that the prior excludes are not tested.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/models/acoustic_frame_model.h"
#include "calib/poses/equally_good.h"

namespace sonarcal::calib {

struct OtherPose {
  int frame = 0;                                // index among the model's frames
  std::vector<std::pair<int, double>> entries;  // pose entries of the frame with their values there
  double worse_by = 0.0;                        // nats, including the prior; negative: fits better
  std::string sentence;
};

// Returns other poses that fit better, or worse by at most kMaxWorseNats, in the order of frames. Tests
// frames with all components of the pose free, and without a free mount offset. `entries` are those of
// FreePlacements.
std::vector<OtherPose> OtherPoses(const AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
                                  const std::vector<int>& entries, const ParameterValues& values);

// Moves each frame to the best of its other poses if that fits better by more than `by_nats`. Returns the
// moved frames.
std::set<int> TakeBetterPoses(const std::vector<OtherPose>& others, double by_nats, ParameterValues& values);

// Returns the reflected pose. `lowest_m` and `highest_m` bound the heights of the visible surfaces.
Pose ReflectedPose(const Pose& world_from_sonar, double lowest_m, double highest_m);

}  // namespace sonarcal::calib
