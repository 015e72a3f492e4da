// Built-in scenes by name, each with viewpoints.
//
//   for (const Environment& environment : Environments()) {
//     const Scene scene = environment.make({});
//     const std::vector<Pose> poses = environment.viewpoints();
//   }
//
// To add one: a file in sim/scenes/ and an entry in environments.cc. Add its materials to
// EnvironmentMaterials.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/pose.h"
#include "core/types/scene.h"
#include "sim/scenes/mockup.h"

namespace sonarcal::sim {

// Options of all scenes. A scene ignores those that do not apply to it.
struct EnvironmentOptions {
  double max_edge_m = 0.0;                    // longest side of the mesh's cells; 0: the scene's own default
  SizeVariant size = SizeVariant::kStandard;  // of tank and mock-up
  bool surface = false;                       // tank: add the water surface
  std::uint64_t seed = 1;                     // seabed: random seed
  bool bed = false;                           // adds a flat bed below a free-standing object (bed_m > 0)
};

struct Environment {
  std::string_view name;         // used in file names
  std::string_view title;        // text for users
  std::string_view description;  // one line
  double bed_m;                  // side of the optional flat bed; 0: no bed
  // Throws DataError for unusable options.
  Scene (*make)(const EnvironmentOptions& options);
  // Poses world_from_sonar for a sonar with a range of about 9 m and a field of view of 45 x 20 degrees.
  std::vector<Pose> (*viewpoints)();
  // Pose sets for recordings of the scene: `poses(set)` with 1 <= set <= pose_sets. No sets: no function.
  int pose_sets = 0;
  std::vector<Pose> (*poses)(int set) = nullptr;
};

const std::vector<Environment>& Environments();

// Throws UsageError for an unknown name and lists the known ones.
const Environment& FindEnvironment(std::string_view name);

// Names of all materials that the environments may have.
std::vector<std::string> EnvironmentMaterials();

// Pose of a sonar at `from_m` that looks at `target_m`, with its right side level.
Pose LookingAt(const Eigen::Vector3d& from_m, const Eigen::Vector3d& target_m);

}  // namespace sonarcal::sim
