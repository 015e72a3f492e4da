// Symmetry of a surface: which turns and reflections map it to itself.
//
// The search of a pose needs it: the roll of a body of revolution is not visible, two poses that differ by a
// turn of the surface onto itself are one, and the mirror image of a pose in the plane of the beams is a pose
// of the same body only if the body has a plane of symmetry.
//
// The candidates are the principal axes of the area. A turn or reflection maps the surface to itself if 98 %
// of points sampled on it lie within a tolerance of it afterwards.
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/types/pose.h"
#include "core/types/scene.h"

namespace sonarcal::calib {

enum class Revolution { kNone, kAxis, kSphere };

struct MeshSymmetry {
  // Frame of the body: origin at the centroid of the area, axes along the principal axes. +x is the axis of
  // revolution if there is one, else the longest direction. Each axis points to the same side as the nearest
  // axis of the mesh.
  Pose mesh_from_body;
  Revolution revolution = Revolution::kNone;
  // Half a turn about the body's x, y, z maps the surface to itself.
  std::array<bool, 3> half_turn = {};
  // The reflection that reverses the body's x, y, z maps the surface to itself.
  std::array<bool, 3> reflection = {};
  double extent_m = 0.0;  // largest distance between two sides of the box along the body's axes
  double radius_m = 0.0;  // largest distance of a vertex from the origin of the body
};

// `tolerance_m`: how far from the surface a turned point may lie; 0: a hundredth of the extent. Throws
// DataError if the scene has no area.
MeshSymmetry FindSymmetry(const Scene& mesh, double tolerance_m = 0.0);

}  // namespace sonarcal::calib
