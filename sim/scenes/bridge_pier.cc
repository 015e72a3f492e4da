#include "sim/scenes/bridge_pier.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Square -1..1 x -1..1, counter-clockwise, each side in `pieces`.
std::vector<Vector2d> SquareSection(int pieces) {
  std::vector<Vector2d> section;
  Vector2d from(1.0, -1.0);
  for (int side = 0; side < 4; ++side) {
    const Vector2d to(-from.y(), from.x());
    for (int piece = 0; piece < pieces; ++piece) section.emplace_back(from + (to - from) * piece / pieces);
    from = to;
  }
  return section;
}

}  // namespace

void BridgePierOptions::Validate() const {
  const auto require = [](const char* field, double value, double low, double high) {
    if (!(value >= low && value <= high)) {
      throw DataError("bridge pier: {} is {}, expected {}..{}", field, value, low, high);
    }
  };
  require("length_m", length_m, 0.1, 1e3);
  require("width_m", width_m, 0.1, 1e3);
  require("height_m", height_m, 0.1, 1e3);
  for (const auto& [field, value_m] : {std::pair{"footing_height_m", footing_height_m},
                                       {"flare_height_m", flare_height_m},
                                       {"head_height_m", head_height_m}}) {
    require(field, value_m, 1e-3 * height_m, 0.33 * height_m);
  }
  require("shaft_foot_share", shaft_foot_share, 0.05, 0.99);
  require("shaft_top_share", shaft_top_share, 0.05, 0.99);
  if (!(max_edge_m > 0.0)) throw DataError("bridge pier: max_edge_m is {}, expected more than 0", max_edge_m);
}

std::vector<ProfilePoint> BridgePierProfile(const BridgePierOptions& o) {
  o.Validate();
  const double head_m = o.height_m - o.head_height_m;
  return {{0.0, 0.0},
          {0.0, 1.0},
          {o.footing_height_m, 1.0},
          {o.footing_height_m, o.shaft_foot_share},
          {head_m - o.flare_height_m, o.shaft_top_share},
          {head_m, 1.0},
          {o.height_m, 1.0},
          {o.height_m, 0.0}};
}

Scene MakeBridgePier(const BridgePierOptions& options) {
  std::vector<ProfilePoint> profile = BridgePierProfile(options);
  const double widest_m = std::max(options.length_m, options.width_m);
  for (ProfilePoint& point : profile) point.radius_m *= 0.5 * widest_m;
  // Along an edge of the flare both half-widths change, so a step there is up to sqrt(2) longer.
  profile = RefineProfile(profile, options.max_edge_m / std::numbers::sqrt2);
  const double pieces = std::ceil(widest_m / options.max_edge_m * (1.0 - 1e-12));
  if (!(pieces <= static_cast<double>(kMaxPrimitiveTriangles))) {
    throw DataError("bridge pier: max_edge_m is {}, which would make more than {} triangles",
                    options.max_edge_m, kMaxPrimitiveTriangles);
  }
  Scene scene =
      MakeLoft(profile, SquareSection(std::max(1, static_cast<int>(pieces))), false, options.material);
  // The loft lies along +x, its section in y and z.
  for (Eigen::Vector3f& vertex_m : scene.vertices_m) {
    const Vector3d lying_m = vertex_m.cast<double>();
    vertex_m = Vector3d(lying_m.y() * options.length_m / widest_m, lying_m.z() * options.width_m / widest_m,
                        lying_m.x())
                   .cast<float>();
  }
  return scene;
}

}  // namespace sonarcal::sim
