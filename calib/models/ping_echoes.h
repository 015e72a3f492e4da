// Echoes of a frame whose pings have their own poses.
#pragma once

#include <vector>

#include "calib/models/acoustic_evaluation.h"
#include "core/types/pings.h"

namespace sonarcal::calib {

// Echoes of a frame with `beams` beams from those of all beams at the pose of each ping. `of_pings` are in
// the order of `pings` and have slopes of the same entries, without logarithms.
FrameEchoes EchoesByPing(const std::vector<PingPose>& pings, int beams,
                         const std::vector<FrameEchoes>& of_pings);

}  // namespace sonarcal::calib
