// Surfaces of a scene that reflect like mirrors: their triangles, and the reflection of rays.
//
// A mirror may be curved. A mesh of flat triangles would break its reflection into facets, so normals are
// interpolated between the corners of a triangle. The normal at a corner is a mean over the triangles of the
// same material that meet there, weighted by their angles at the corner. Triangles that turn away by more
// than 40 degrees are excluded, because there is an edge, such as between floor and wall. Flat surfaces stay
// exactly flat.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/types/scene.h"

namespace sonarcal::sim {

// Thin bundle of rays: its axis, and the divergence of two directions that leave the sonar perpendicular to
// the axis and to each other.
struct RayBundle {
  Eigen::Vector3d point_m;    // last reflection of the axis; at first the sonar
  Eigen::Vector3d direction;  // unit vector
  double length_m = 0.0;      // path from the sonar to `point_m`
  bool bent = false;          // reflected by a curved mirror: no longer spreads with its length
  Eigen::Matrix<double, 3, 2> offset_m = Eigen::Matrix<double, 3, 2>::Zero();  // at `point_m`, per radian
  Eigen::Matrix<double, 3, 2> turn = Eigen::Matrix<double, 3, 2>::Zero();      // of the direction, per radian

  // `may_bend`: whether a curved mirror may follow. Otherwise the divergence stays 0; SpreadingM
  // does not use it.
  RayBundle(const Eigen::Vector3d& from_m, const Eigen::Vector3d& towards, bool may_bend = true);

  Eigen::Vector3d At(double range_m) const { return point_m + range_m * direction; }

  // Square root of the bundle's cross-section per steradian, `range_m` from `point_m`. It replaces range in
  // spherical spreading. Equals the bundle's length if no mirror was curved. At least a centimetre at a
  // focus, because a wave has no point focus.
  double SpreadingM(double range_m) const;
};

class MirrorSurface {
 public:
  // `reflects`: one value per material of the scene. The scene must outlive the surface.
  MirrorSurface(const Scene& scene, const std::vector<char>& reflects);

  // True if any mirror is curved.
  bool bends() const { return !corner_normal_.empty(); }
  bool Reflects(int triangle) const { return reflects_[scene_.triangle_material[triangle]] != 0; }

  // Bundle after its reflection by the triangle, `range_m` from its point. If an interpolated normal would
  // send it through the surface, as at grazing incidence, the triangle's own normal is used.
  RayBundle Reflected(const RayBundle& bundle, int triangle, double range_m) const;

  // Planes of flat mirrors, normal . point = offset. PlaneOf returns the plane of a triangle, or kNoPlane if
  // it is no mirror or curved.
  struct Plane {
    Eigen::Vector3d normal;
    double offset_m;

    Eigen::Vector3d ImageOf(const Eigen::Vector3d& point_m) const {
      return point_m - 2.0 * (normal.dot(point_m) - offset_m) * normal;
    }
  };
  static constexpr std::int32_t kNoPlane = -1;
  const std::vector<Plane>& planes() const { return planes_; }
  std::int32_t PlaneOf(int triangle) const { return plane_of_[triangle]; }

  // Largest absolute coordinate of the scene's vertices.
  double largest_coordinate_m() const { return largest_coordinate_m_; }

 private:
  static constexpr std::int32_t kFlat = -1;

  const Scene& scene_;
  std::vector<char> reflects_;
  std::vector<std::int32_t> corners_of_;        // per triangle: first of three in corner_normal_, or kFlat
  std::vector<Eigen::Vector3f> corner_normal_;  // unit length
  std::vector<Plane> planes_;
  std::vector<std::int32_t> plane_of_;        // per triangle
  std::vector<std::int32_t> normal_of_;       // per triangle: index into flat_normal_, if it reflects
  std::vector<Eigen::Vector3d> flat_normal_;  // unit length, of the triangle itself
  double largest_coordinate_m_ = 0.0;
};

}  // namespace sonarcal::sim
