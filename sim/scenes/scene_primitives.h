// Closed and open triangle meshes from which scenes are built.
//
// Every shape has one material and shared vertices. Triangles run counter-clockwise seen from outside, so
// normals point outwards. "Closed" means that each edge belongs to exactly two triangles, once in each
// direction. Curved surfaces are inscribed: their vertices lie on the true surface and nothing extends beyond
// it. Lengths are in metres and kept in double until they become vertices.
//
// `max_edge_m` divides a shape until no side of its quadrilaterals is longer; kUndivided does not divide it.
// A size that is not positive, or more than kMaxPrimitiveTriangles triangles, throws DataError.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "core/types/scene.h"

namespace sonarcal::sim {

inline constexpr double kUndivided = std::numeric_limits<double>::infinity();
inline constexpr std::size_t kMaxPrimitiveTriangles = 20'000'000;

// Parallelogram corner + s side_u + t side_v, 0 <= s, t <= 1; its normal is side_u x side_v.
Scene MakePatch(const Eigen::Vector3d& corner_m, const Eigen::Vector3d& side_u_m,
                const Eigen::Vector3d& side_v_m, double max_edge_m, const std::string& material);

// Closed box between two corners, min_m < max_m in each coordinate.
Scene MakeBox(const Eigen::Vector3d& min_m, const Eigen::Vector3d& max_m, double max_edge_m,
              const std::string& material);

// Point of a profile: distance along the axis, and from the axis.
struct ProfilePoint {
  double axial_m = 0.0;
  double radius_m = 0.0;
};

// Profile with added points so that no segment is longer than max_edge_m.
std::vector<ProfilePoint> RefineProfile(const std::vector<ProfilePoint>& profile, double max_edge_m);

// Number of sectors that keeps a circle's chords within max_edge_m; at least `at_least`.
int SectorsFor(double radius_m, double max_edge_m, int at_least);

// Surface that a profile sweeps around the +X axis in `sectors` (>= 3) plane sectors. Outside lies to the
// left of the profile in the (axial, radius) plane: draw a convex body from its lowest to its highest end. An
// open profile must start and end on the axis (radius 0); the mesh is closed. With `ring`, the profile's end
// joins its start, all radii must be positive, and the mesh is a closed ring.
Scene MakeRevolution(const std::vector<ProfilePoint>& profile, int sectors, bool ring,
                     const std::string& material);

// The closed solid of revolution about the +X axis through a table of radii, with flat ends: `outline` (two
// or more points, positive radii) runs from its lowest to its highest end.
Scene MakeTurnedSolid(const std::vector<ProfilePoint>& outline, double max_edge_m,
                      const std::string& material);

// As MakeRevolution, with a polygon in place of the circle: `section` (>= 3 points, counter-clockwise seen
// from +X, in the y-z plane about the axis) is scaled by the profile's radius.
Scene MakeLoft(const std::vector<ProfilePoint>& profile, const std::vector<Eigen::Vector2d>& section,
               bool ring, const std::string& material);

// Closed cylinder from base_m to base_m + axis_m.
Scene MakeCylinder(const Eigen::Vector3d& base_m, const Eigen::Vector3d& axis_m, double radius_m,
                   double max_edge_m, const std::string& material);

// Closed tube between two radii, from base_m to base_m + axis_m.
Scene MakeTube(const Eigen::Vector3d& base_m, const Eigen::Vector3d& axis_m, double inner_radius_m,
               double outer_radius_m, double max_edge_m, const std::string& material);

// Scene with every vertex moved by a rigid transform.
Scene Moved(Scene scene, const Eigen::Isometry3d& world_from_scene);

}  // namespace sonarcal::sim
