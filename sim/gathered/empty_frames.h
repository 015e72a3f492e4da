// Detects poses from which a sonar sees nothing of a scene. The usual cause is a mistake in units, axes or
// poses.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/simulator.h"

namespace sonarcal::sim {

// Indices of the poses from which no ray of the simulator hits the scene within the range window. Casts few
// rays for a pose that sees something, all rays for one that does not. Calls `progress(done)`, which may
// throw, after each pose.
std::vector<int> PosesThatSeeNothing(const Simulator& simulator, const std::vector<Pose>& world_from_sonar,
                                     const std::function<void(int done)>& progress = {});

// Warning about the `empty` ones of these frames, from which no ray hits the scene; empty if there is none.
// Throws DataError if it is all of them, because they say nothing about the scene.
std::string CheckSceneIsSeen(const Simulator& simulator, const std::vector<Pose>& world_from_sonar,
                             const std::vector<int>& frames, const std::vector<int>& empty);
// Looks which frames are empty, and calls the function above.
std::string CheckSceneIsSeen(const Simulator& simulator, const std::vector<Pose>& world_from_sonar,
                             const std::vector<int>& frames);

// Warning about the `empty` poses, with the likely reason for the first of them.
std::string EmptyFramesWarning(const Simulator& simulator, const std::vector<Pose>& world_from_sonar,
                               const std::vector<int>& empty);

}  // namespace sonarcal::sim
