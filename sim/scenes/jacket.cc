#include "sim/scenes/jacket.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <utility>

#include "core/types/error.h"
#include "sim/scenes/scene_primitives.h"

namespace sonarcal::sim {
namespace {

using Eigen::Vector3d;

// Fractions of the jacket's height: the upright pieces at a leg's ends, and the lowest and highest levels.
constexpr double kFootShare = 0.09;
constexpr double kHeadShare = 0.07;
constexpr double kLowestLevelShare = 0.14;
constexpr double kHighestLevelShare = 0.90;

// Positions of the legs, counter-clockwise from above.
constexpr std::array<std::pair<double, double>, 4> kCorners = {
    {{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}};

Scene MakePipe(const Pipe& pipe, const JacketOptions& options) {
  const Vector3d axis_m = pipe.to_m - pipe.from_m;
  const double length_m = axis_m.norm();
  const std::vector<ProfilePoint> profile = {
      {0.0, 0.0}, {0.0, pipe.radius_m}, {length_m, pipe.radius_m}, {length_m, 0.0}};
  Eigen::Isometry3d world_from_pipe = Eigen::Isometry3d::Identity();
  world_from_pipe.rotate(Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), axis_m));
  world_from_pipe.pretranslate(pipe.from_m);
  return Moved(MakeRevolution(RefineProfile(profile, options.max_edge_m),
                              JacketSectors(options, pipe.radius_m), false, options.material),
               world_from_pipe);
}

}  // namespace

void JacketOptions::Validate() const {
  const auto require = [](const char* field, double value, double low, double high) {
    if (!(value >= low && value <= high)) {
      throw DataError("jacket: {} is {}, expected {}..{}", field, value, low, high);
    }
  };
  require("length_m", length_m, 0.1, 1e3);
  require("width_m", width_m, 0.1, 1e3);
  require("height_m", height_m, 0.1, 1e3);
  require("top_share", top_share, 0.2, 1.0);
  require("bays", bays, 1, 20);
  const double narrowest_m = top_share * std::min(length_m, width_m);
  require("foot_diameter_m", foot_diameter_m, 1e-3, std::min(0.4 * narrowest_m, kHeadShare * 2.0 * height_m));
  // Each pipe ends within a thicker one.
  require("leg_diameter_m", leg_diameter_m, 1e-3, 0.9 * foot_diameter_m);
  require("level_diameter_m", level_diameter_m, 1e-3, 0.9 * leg_diameter_m);
  require("brace_diameter_m", brace_diameter_m, 1e-3, 0.9 * leg_diameter_m);
  require("sectors", sectors, 8, 10000);
  if (!(max_edge_m > 0.0)) throw DataError("jacket: max_edge_m is {}, expected more than 0", max_edge_m);
}

int JacketSectors(const JacketOptions& options, double radius_m) {
  // A multiple of 4 puts vertices at the pipe's rightmost, leftmost, front and back points, so that sizes are
  // exact.
  return (SectorsFor(radius_m, options.max_edge_m, options.sectors) + 3) / 4 * 4;
}

std::vector<Pipe> JacketPipes(const JacketOptions& o) {
  o.Validate();
  const double foot_radius_m = 0.5 * o.foot_diameter_m;
  const double leg_radius_m = 0.5 * o.leg_diameter_m;
  const Vector3d foot_m(0.5 * o.length_m - foot_radius_m, 0.5 * o.width_m - foot_radius_m, 0.0);
  const Vector3d head_m(0.5 * o.top_share * o.length_m - foot_radius_m,
                        0.5 * o.top_share * o.width_m - foot_radius_m, o.height_m);
  // Legs run from the middle of a foot to the middle of a head.
  const double leg_foot_m = 0.5 * kFootShare * o.height_m;
  const double leg_head_m = (1.0 - 0.5 * kHeadShare) * o.height_m;
  const auto on_leg = [&](int leg, double z_m) {
    const double part = (z_m - leg_foot_m) / (leg_head_m - leg_foot_m);
    const Vector3d place_m = foot_m + part * (head_m - foot_m);
    return Vector3d(kCorners[leg].first * place_m.x(), kCorners[leg].second * place_m.y(), z_m);
  };
  const auto level_m = [&](int level) {
    const double share = kLowestLevelShare + (kHighestLevelShare - kLowestLevelShare) * level / o.bays;
    return share * o.height_m;
  };

  std::vector<Pipe> pipes;
  for (int leg = 0; leg < 4; ++leg) {
    Vector3d bottom_m = on_leg(leg, leg_foot_m);
    Vector3d top_m = on_leg(leg, leg_head_m);
    pipes.push_back({bottom_m, top_m, leg_radius_m});
    bottom_m.z() = 0.0;
    pipes.push_back({bottom_m, bottom_m + kFootShare * o.height_m * Vector3d::UnitZ(), foot_radius_m});
    top_m.z() = (1.0 - kHeadShare) * o.height_m;
    pipes.push_back({top_m, top_m + kHeadShare * o.height_m * Vector3d::UnitZ(), foot_radius_m});
  }
  for (int side = 0; side < 4; ++side) {
    const int next = (side + 1) % 4;
    for (int level = 0; level <= o.bays; ++level) {
      const double z_m = level_m(level);
      pipes.push_back({on_leg(side, z_m), on_leg(next, z_m), 0.5 * o.level_diameter_m});
      if (level == o.bays) continue;
      const double above_m = level_m(level + 1);
      pipes.push_back({on_leg(side, z_m), on_leg(next, above_m), 0.5 * o.brace_diameter_m});
      pipes.push_back({on_leg(next, z_m), on_leg(side, above_m), 0.5 * o.brace_diameter_m});
    }
  }
  return pipes;
}

Scene MakeJacket(const JacketOptions& options) {
  Scene scene;
  for (const Pipe& pipe : JacketPipes(options)) {
    scene.Append(MakePipe(pipe, options));
    if (scene.triangles.size() > kMaxPrimitiveTriangles) {
      throw DataError("jacket: max_edge_m is {}, which makes more than {} triangles", options.max_edge_m,
                      kMaxPrimitiveTriangles);
    }
  }
  return scene;
}

}  // namespace sonarcal::sim
