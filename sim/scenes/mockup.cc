#include "sim/scenes/mockup.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/scenes/scene_primitives.h"

namespace sonarcal::sim {
namespace {

using Eigen::Vector3d;

// Depth by which touching solids penetrate each other, so that no two faces lie in one plane.
constexpr double kSunk_m = 0.005;

// One side of the block, in its own frame: x to the right and y up as seen from outside, z outwards. Origin
// in the middle of the panel between the posts; z = 0 on the core's face, `relief_m` on the nominal face.
struct Panel {
  double width_m;   // between the posts
  double height_m;  // between the beams
  double relief_m;
  double max_edge_m;
  const std::string* material;

  // Bar with this centre and size that rises from the core to `rise` of the relief.
  Scene Bar(double x_m, double y_m, double bar_width_m, double bar_height_m, double rise) const {
    const Vector3d half_m(0.5 * bar_width_m, 0.5 * bar_height_m, 0.0);
    const Vector3d middle_m(x_m, y_m, 0.0);
    return MakeBox(middle_m - half_m - kSunk_m * Vector3d::UnitZ(),
                   middle_m + half_m + rise * relief_m * Vector3d::UnitZ(), max_edge_m, *material);
  }

  // Disc on the core.
  Scene Stub(double x_m, double y_m, double radius_m, double rise) const {
    return MakeCylinder({x_m, y_m, -kSunk_m}, (rise * relief_m + kSunk_m) * Vector3d::UnitZ(), radius_m,
                        max_edge_m, *material);
  }
  Scene Flange(double x_m, double y_m, double inner_radius_m, double outer_radius_m, double rise) const {
    return MakeTube({x_m, y_m, -kSunk_m}, (rise * relief_m + kSunk_m) * Vector3d::UnitZ(), inner_radius_m,
                    outer_radius_m, max_edge_m, *material);
  }
};

Scene CrossPattern(const Panel& panel) {
  const double side_m = 0.8 * std::min(panel.width_m, panel.height_m);
  const double bar_m = 0.1 * side_m;
  const double arm_m = 0.5 * (side_m - bar_m);
  Scene scene;
  for (const double sign : {-1.0, 1.0}) {
    // Upright bars of the rim lie between the level ones and penetrate them.
    scene.Append(panel.Bar(0.0, sign * arm_m, side_m, bar_m, 0.8));
    scene.Append(panel.Bar(sign * (arm_m - kSunk_m), 0.0, bar_m, side_m - 1.5 * bar_m, 0.75));
  }
  scene.Append(panel.Bar(0.0, 0.0, 0.6 * side_m, 1.5 * bar_m, 0.9));
  scene.Append(panel.Bar(0.0, 0.0, 1.5 * bar_m, 0.6 * side_m, 0.85));
  return scene;
}

Scene PipesPattern(const Panel& panel) {
  constexpr int kPipes = 5;
  const double pitch_m = panel.width_m / kPipes;
  const double radius_m = std::min(0.45 * panel.relief_m, 0.4 * pitch_m);
  const double length_m = 0.9 * panel.height_m;
  Scene scene;
  for (int pipe = 0; pipe < kPipes; ++pipe) {
    const double x_m = (pipe - 0.5 * (kPipes - 1)) * pitch_m;
    // Two clamps hold each pipe's axis half a relief away from the core.
    scene.Append(MakeCylinder({x_m, -0.5 * length_m, 0.5 * panel.relief_m}, length_m * Vector3d::UnitY(),
                              radius_m, panel.max_edge_m, *panel.material));
  }
  for (const double sign : {-1.0, 1.0}) {
    scene.Append(panel.Bar(0.0, sign * 0.3 * panel.height_m, 0.95 * panel.width_m, radius_m, 0.5));
  }
  return scene;
}

Scene PortsPattern(const Panel& panel) {
  const double radius_m = 0.25 * std::min(panel.width_m, panel.height_m);
  Scene scene;
  scene.Append(panel.Flange(0.0, 0.0, 0.7 * radius_m, radius_m, 0.9));
  scene.Append(panel.Stub(0.0, 0.0, 0.35 * radius_m, 0.95));
  for (const double x_sign : {-1.0, 1.0}) {
    for (const double y_sign : {-1.0, 1.0}) {
      scene.Append(panel.Flange(x_sign * 0.35 * panel.width_m, y_sign * 0.36 * panel.height_m, 0.2 * radius_m,
                                0.4 * radius_m, 0.6));
    }
  }
  return scene;
}

Scene RibsPattern(const Panel& panel) {
  constexpr int kRibs = 6;
  const double pitch_m = panel.height_m / kRibs;
  Scene scene;
  for (int rib = 0; rib < kRibs; ++rib) {
    scene.Append(
        panel.Bar(0.0, (rib - 0.5 * (kRibs - 1)) * pitch_m, 0.94 * panel.width_m, 0.35 * pitch_m, 0.8));
  }
  return scene;
}

Scene MakePattern(MockupPattern pattern, const Panel& panel) {
  switch (pattern) {
    case MockupPattern::kCross:
      return CrossPattern(panel);
    case MockupPattern::kPipes:
      return PipesPattern(panel);
    case MockupPattern::kPorts:
      return PortsPattern(panel);
    case MockupPattern::kRibs:
      return RibsPattern(panel);
  }
  throw DataError("mock-up pattern {}, expected one of 0..3", static_cast<int>(pattern));
}

// Corner posts that reach the nominal faces, with level beams between them at bottom and top, slightly
// recessed.
Scene MakeFrame(const MockupOptions& o) {
  const double post_m = 1.5 * o.relief_m;
  const Vector3d half_m(0.5 * o.length_m, 0.5 * o.width_m, 0.0);
  Scene frame;
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      const Vector3d outer_m(sx * half_m.x(), sy * half_m.y(), 0.0);
      const Vector3d inner_m = outer_m - post_m * Vector3d(sx, sy, 0.0);
      frame.Append(MakeBox(outer_m.cwiseMin(inner_m),
                           outer_m.cwiseMax(inner_m) + o.height_m * Vector3d::UnitZ(), o.max_edge_m,
                           o.material));
    }
  }
  // Beams along x (axis 0) and y (axis 1), with their ends inside the posts.
  const double beam_top_m = o.height_m - kSunk_m;
  for (const int along : {0, 1}) {
    const int across = 1 - along;
    for (const double sign : {-1.0, 1.0}) {
      const double outer_m = sign * (half_m[across] - kSunk_m);
      const double inner_m = sign * (half_m[across] - post_m + kSunk_m);
      for (const double bottom_m : {kSunk_m, beam_top_m - post_m}) {
        Vector3d low_m, high_m;
        high_m[along] = half_m[along] - 0.5 * post_m;
        low_m[along] = -high_m[along];
        low_m[across] = std::min(outer_m, inner_m);
        high_m[across] = std::max(outer_m, inner_m);
        low_m.z() = bottom_m;
        high_m.z() = bottom_m + post_m;
        frame.Append(MakeBox(low_m, high_m, o.max_edge_m, o.material));
      }
    }
  }
  return frame;
}

// Head of the well: a hub inside a guide ring.
Scene MakeTop(const MockupOptions& o) {
  const double radius_m = 0.3 * std::min(o.length_m, o.width_m);
  const Vector3d base_m(0.0, 0.0, o.height_m - o.relief_m - kSunk_m);
  const auto rise = [&](double part) -> Vector3d {
    return (part * o.relief_m + kSunk_m) * Vector3d::UnitZ();
  };
  Scene top = MakeTube(base_m, rise(0.7), 0.85 * radius_m, radius_m, o.max_edge_m, o.material);
  top.Append(MakeCylinder(base_m, rise(0.95), 0.5 * radius_m, o.max_edge_m, o.material));
  return top;
}

}  // namespace

void MockupOptions::Validate() const {
  for (const auto& [name, value_m] :
       {std::pair{"length_m", length_m}, {"width_m", width_m}, {"height_m", height_m}}) {
    if (!(value_m >= 0.1 && value_m <= 100.0)) {
      throw DataError("mock-up: {} is {}, expected 0.1..100", name, value_m);
    }
  }
  const double smallest_m = std::min({length_m, width_m, height_m});
  const double relief_min_m = 4.0 * kSunk_m;
  const double relief_max_m = 0.25 * smallest_m;
  if (!(relief_m >= relief_min_m && relief_m <= relief_max_m)) {
    throw DataError("mock-up: relief_m is {}, expected {}..{} for a smallest side of {} m", relief_m,
                    relief_min_m, relief_max_m, smallest_m);
  }
  if (!(max_edge_m > 0.0)) throw DataError("mock-up: max_edge_m is {}, expected more than 0", max_edge_m);
}

MockupOptions MockupOfSize(SizeVariant size) {
  MockupOptions options;
  if (size == SizeVariant::kAlternative) options.height_m = 1.0;
  return options;
}

Scene MakeMockup(const MockupOptions& options) {
  options.Validate();
  const MockupOptions& o = options;
  const Vector3d core_max_m(0.5 * o.length_m - o.relief_m, 0.5 * o.width_m - o.relief_m,
                            o.height_m - o.relief_m);
  Scene scene = MakeBox({-core_max_m.x(), -core_max_m.y(), 0.0}, core_max_m, o.max_edge_m, o.material);
  scene.Append(MakeFrame(o));
  scene.Append(MakeTop(o));

  const double frame_m = 2.0 * 1.5 * o.relief_m;  // width of both posts, or height of both beams
  for (int side = 0; side < 4; ++side) {
    const bool faces_y = side % 2 == 0;
    const Panel panel{(faces_y ? o.length_m : o.width_m) - frame_m, o.height_m - frame_m, o.relief_m,
                      o.max_edge_m, &o.material};
    // Side 0 faces -y; each next side is a quarter turn to the left. On side 0 the panel's x, y, z become the
    // object's x, z and -y.
    Eigen::Isometry3d object_from_panel = Eigen::Isometry3d::Identity();
    object_from_panel.rotate(Eigen::AngleAxisd(0.5 * kPi * side, Vector3d::UnitZ()));
    object_from_panel.translate(
        Vector3d(0.0, -(faces_y ? core_max_m.y() : core_max_m.x()), 0.5 * o.height_m));
    object_from_panel.rotate(Eigen::AngleAxisd(0.5 * kPi, Vector3d::UnitX()));
    scene.Append(Moved(MakePattern(o.patterns[side], panel), object_from_panel));
  }
  return scene;
}

MockupOptions RefinedTo(MockupOptions options, int triangles) {
  if (triangles > kMaxMockupTriangles) {
    throw DataError("mock-up: {} triangles asked for, expected at most {}", triangles, kMaxMockupTriangles);
  }
  options.max_edge_m = kUndivided;
  Scene mesh = MakeMockup(options);
  double edge_m = std::max({options.length_m, options.width_m, options.height_m});
  while (static_cast<int>(mesh.triangles.size()) < triangles) {
    // The number of triangles grows with the inverse square of their size, once all shapes are divided.
    const double lacking = triangles / static_cast<double>(mesh.triangles.size());
    edge_m *= std::clamp(0.98 / std::sqrt(lacking), 0.5, 0.95);
    options.max_edge_m = edge_m;
    mesh = MakeMockup(options);
  }
  return options;
}

}  // namespace sonarcal::sim
