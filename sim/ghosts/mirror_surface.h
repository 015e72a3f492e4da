// Surfaces of a scene that reflect like mirrors: which triangles they are, and how rays leave them.
//
// A mirror may be curved. A mesh of flat triangles would then break what it reflects into facets, so normals
// are taken between the corners of a triangle: at a corner, the mean of the normals of all triangles of the
// same material that meet there and turn away by no more than 40 degrees, weighted by their angles at the
// corner. Beyond 40 degrees lies an edge, where floor meets wall. Flat surfaces stay exactly flat.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/types/scene.h"

namespace sonarcal::sim {

// A thin bundle of rays on its way: its axis, and how two directions that leave the sonar at a right angle
// to the axis and to each other part from it.
struct RayBundle {
  Eigen::Vector3d point_m;    // where the axis was last reflected; the sonar to begin with
  Eigen::Vector3d direction;  // unit vector
  double length_m = 0.0;      // from the sonar to `point_m`
  bool bent = false;          // by a curved mirror: it no longer spreads with its length
  Eigen::Matrix<double, 3, 2> offset_m = Eigen::Matrix<double, 3, 2>::Zero();  // at `point_m`, a radian
  Eigen::Matrix<double, 3, 2> turn;                                            // of the direction, a radian

  RayBundle(const Eigen::Vector3d& from_m, const Eigen::Vector3d& towards);

  Eigen::Vector3d At(double range_m) const { return point_m + range_m * direction; }

  // The root of the bundle's cross-section a steradian, `range_m` from `point_m`: what stands for range in
  // spherical spreading. Its own length where no mirror was curved. At a focus, where a wave of some length
  // comes to no point, a centimetre.
  double SpreadingM(double range_m) const;
};

class MirrorSurface {
 public:
  // `reflects`: one a material of the scene, which must outlive the surface.
  MirrorSurface(const Scene& scene, const std::vector<char>& reflects);

  bool Reflects(int triangle) const { return reflects_[scene_.triangle_material[triangle]] != 0; }

  // The bundle after it met the triangle `range_m` from its point. Where a normal between corners would send
  // it through the surface, as may happen at grazing, the triangle's own is taken.
  RayBundle Reflected(const RayBundle& bundle, int triangle, double range_m) const;

  // Flat mirrors by their planes, normal . point = offset; which of them a triangle lies in, none where it is
  // no mirror or curved.
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

  // Of any of the scene's vertices.
  double largest_coordinate_m() const { return largest_coordinate_m_; }

 private:
  static constexpr std::int32_t kFlat = -1;

  const Scene& scene_;
  std::vector<char> reflects_;
  std::vector<std::int32_t> corners_of_;        // of a triangle: first of three in corner_normal_, or kFlat
  std::vector<Eigen::Vector3f> corner_normal_;  // unit length
  std::vector<Plane> planes_;
  std::vector<std::int32_t> plane_of_;  // one a triangle
  double largest_coordinate_m_ = 0.0;
};

}  // namespace sonarcal::sim
