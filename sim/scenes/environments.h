// The scenes by name, each with the places to look at it from: those of Park 2024 Section 5 (seabed, bridge
// pier, jacket; Figs. 5 to 8) and of Section 6 (tank, mock-up).
//
//   for (const Environment& environment : Environments()) {
//     const Scene scene = environment.make({});
//     const std::vector<Pose> poses = environment.viewpoints();
//   }
//
// To add one: a file in sim/scenes/, and an entry in environments.cc. Its materials belong into
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

// What a scene may take; each takes what concerns it.
struct EnvironmentOptions {
  double max_edge_m = 0.0;              // longest side of the mesh's cells; 0: the scene's own default
  PaperSize size = PaperSize::kTable5;  // of tank and mock-up
  bool surface = false;                 // tank: add the water's surface
  std::uint64_t seed = 1;               // seabed
  bool bed = false;                     // what stands free (bed_m > 0) gets a flat bed to stand on
};

struct Environment {
  std::string_view name;         // of files
  std::string_view title;        // for people
  std::string_view description;  // one line
  double bed_m;                  // side of the flat bed it may stand on; 0: it needs none
  // Throws DataError for options that cannot be used.
  Scene (*make)(const EnvironmentOptions& options);
  // Poses world_from_sonar for a sonar that sees about 9 m far, 45 degrees wide and 20 degrees high. The
  // paper tells none of its own: these are ours.
  std::vector<Pose> (*viewpoints)();
};

const std::vector<Environment>& Environments();

// Throws UsageError that lists the names for an unknown one.
const Environment& FindEnvironment(std::string_view name);

// The names of all materials that the environments may have.
std::vector<std::string> EnvironmentMaterials();

// A sonar at `from_m` that looks at `target_m`, its right side level.
Pose LookingAt(const Eigen::Vector3d& from_m, const Eigen::Vector3d& target_m);

}  // namespace sonarcal::sim
