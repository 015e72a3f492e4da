#include "sim/scenes/environments.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/text/nearest_word.h"
#include "core/types/error.h"
#include "sim/scenes/bridge_pier.h"
#include "sim/scenes/jacket.h"
#include "sim/scenes/scene_primitives.h"
#include "sim/scenes/scenes.h"
#include "sim/scenes/seabed.h"

namespace sonarcal::sim {
namespace {

using Eigen::Vector3d;

// Flat square about the origin at height 0, normal up.
Scene FlatBed(double side_m, double max_edge_m, const std::string& material) {
  return MakePatch({-0.5 * side_m, -0.5 * side_m, 0.0}, side_m * Vector3d::UnitX(),
                   side_m * Vector3d::UnitY(), max_edge_m > 0.0 ? max_edge_m : kUndivided, material);
}

constexpr double kMockupBed_m = 12.0;
constexpr double kPierBed_m = 24.0;
constexpr double kJacketBed_m = 24.0;

template <typename Options>
Options Resolved(Options own, const EnvironmentOptions& options) {
  if (options.max_edge_m != 0.0) own.max_edge_m = options.max_edge_m;
  return own;
}

Scene Tank(const EnvironmentOptions& options) {
  MockupTankOptions tank = MockupTankOfSize(options.size);
  tank.tank = Resolved(tank.tank, options);
  tank.mockup = Resolved(tank.mockup, options);
  tank.tank.surface = options.surface;
  return MakeMockupTank(tank);
}

Scene Mockup(const EnvironmentOptions& options) {
  Scene scene = MakeMockup(Resolved(MockupOfSize(options.size), options));
  if (options.bed) scene.Append(FlatBed(kMockupBed_m, options.max_edge_m, "floor"));
  return scene;
}

Scene Seabed(const EnvironmentOptions& options) {
  SeabedOptions seabed = Resolved(SeabedOptions{}, options);
  seabed.seed = options.seed;
  return MakeSeabed(seabed);
}

Scene BridgePier(const EnvironmentOptions& options) {
  Scene scene = MakeBridgePier(Resolved(BridgePierOptions{}, options));
  if (options.bed) scene.Append(FlatBed(kPierBed_m, options.max_edge_m, "seabed"));
  return scene;
}

Scene Jacket(const EnvironmentOptions& options) {
  Scene scene = MakeJacket(Resolved(JacketOptions{}, options));
  if (options.bed) scene.Append(FlatBed(kJacketBed_m, options.max_edge_m, "seabed"));
  return scene;
}

std::vector<Pose> TankViewpoints() {
  return {MockupTankPoses(1)[0], MockupTankPoses(1)[2], MockupTankPoses(2)[1], MockupTankPoses(3)[0]};
}

// Viewpoints around the block, one per side.
std::vector<Pose> MockupViewpoints() {
  const Vector3d target_m(0.0, 0.0, 0.5);
  return {LookingAt({0.3, -3.6, 1.5}, target_m), LookingAt({3.1, -2.4, 1.7}, target_m),
          LookingAt({3.8, 0.6, 1.6}, target_m), LookingAt({-2.6, 3.4, 1.9}, target_m)};
}

// Viewpoints above the four sides, looking inwards.
std::vector<Pose> SeabedViewpoints() {
  return {LookingAt({0.0, -4.8, 3.2}, {0.0, 0.2, 1.1}), LookingAt({4.6, -4.2, 3.4}, {0.6, 0.0, 1.1}),
          LookingAt({4.8, 1.0, 3.0}, {0.0, 0.4, 1.0}), LookingAt({-3.6, 4.6, 3.2}, {-0.4, 0.2, 1.0})};
}

// Viewpoints: face-on and along a diagonal at the foot, at the middle of the shaft, and down on the head.
std::vector<Pose> BridgePierViewpoints() {
  return {LookingAt({0.0, -7.0, 2.8}, {0.0, -1.2, 1.4}), LookingAt({4.9, -4.5, 3.0}, {0.8, -0.6, 1.5}),
          LookingAt({-5.6, -2.2, 5.6}, {-1.0, -0.3, 4.2}), LookingAt({1.8, 6.2, 10.6}, {0.2, 1.6, 9.2})};
}

std::vector<Pose> JacketViewpoints() {
  return {LookingAt({0.0, -6.6, 2.8}, {0.0, -1.5, 1.5}), LookingAt({5.2, -4.6, 4.2}, {0.6, -0.4, 2.8}),
          LookingAt({-6.6, 1.0, 6.2}, {-0.8, 0.2, 4.6}), LookingAt({1.2, 5.4, 9.6}, {0.0, 0.6, 6.8})};
}

}  // namespace

const std::vector<Environment>& Environments() {
  static const std::vector<Environment> kEnvironments = {
      {"tank", "Tank", "Test tank, 12 x 10 x 1.5 m, with two mock-ups (Park 2024 Table 5, Fig. 10)", 0.0,
       Tank, TankViewpoints, kMockupTankPoseSets, MockupTankPoses},
      {"mockup", "Mock-up", "Scaled subsea well, 1 x 1 x 1.5 m, another pattern on each side (Fig. 9)",
       kMockupBed_m, Mockup, MockupViewpoints},
      {"seabed", "Seabed", "Smooth seabed with relief, 10 x 10 x 2 m (Figs. 5a and 6)", 0.0, Seabed,
       SeabedViewpoints},
      {"bridge_pier", "Bridge pier", "Polyhedron with footing and head, 4 x 4 x 9.5 m (Figs. 5b and 7)",
       kPierBed_m, BridgePier, BridgePierViewpoints},
      {"jacket", "Jacket",
       "Frame of pipes, four legs with level pipes and braces, 5 x 5 x 8.5 m (Figs. 5c and 8)", kJacketBed_m,
       Jacket, JacketViewpoints},
  };
  return kEnvironments;
}

const Environment& FindEnvironment(std::string_view name) {
  std::vector<std::string> names;
  for (const Environment& environment : Environments()) {
    if (environment.name == name) return environment;
    names.emplace_back(environment.name);
  }
  throw UsageError("unknown scene '{}'{}", name, ExpectedWord(name, names));
}

std::vector<std::string> EnvironmentMaterials() {
  return {"floor", "wall", "mockup", "surface", "seabed", "pier", "jacket"};
}

Pose LookingAt(const Vector3d& from_m, const Vector3d& target_m) {
  const Vector3d ahead_m = target_m - from_m;
  SONARCAL_CHECK(std::hypot(ahead_m.x(), ahead_m.y()) > 0.0, "a view straight up or down has no heading");
  const double yaw_rad = std::atan2(-ahead_m.x(), ahead_m.y());
  const double pitch_rad = std::atan2(ahead_m.z(), std::hypot(ahead_m.x(), ahead_m.y()));
  return {RotationFromYawPitchRoll(yaw_rad, pitch_rad, 0.0), from_m};
}

}  // namespace sonarcal::sim
