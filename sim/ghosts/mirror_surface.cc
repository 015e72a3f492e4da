#include "sim/ghosts/mirror_surface.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/types/units.h"

namespace sonarcal::sim {
namespace {

constexpr double kCreaseDeg = 40.0;
constexpr double kSmallestSpreadingM = 0.01;
// Tolerance for the rounding of normals of triangles in one plane.
constexpr double kFlatWithin = 1e-5;

Eigen::Vector3d Mirrored(const Eigen::Vector3d& direction, const Eigen::Vector3d& normal) {
  return direction - 2.0 * direction.dot(normal) * normal;
}

std::array<Eigen::Vector3d, 3> CornersM(const Scene& scene, int triangle) {
  const Eigen::Vector3i& t = scene.triangles[triangle];
  return {scene.vertices_m[t[0]].cast<double>(), scene.vertices_m[t[1]].cast<double>(),
          scene.vertices_m[t[2]].cast<double>()};
}

Eigen::Vector3d NormalOf(const std::array<Eigen::Vector3d, 3>& corner) {
  return (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
}

}  // namespace

RayBundle::RayBundle(const Eigen::Vector3d& from_m, const Eigen::Vector3d& towards, bool may_bend)
    : point_m(from_m), direction(towards) {
  if (!may_bend) return;
  turn.col(0) = direction.unitOrthogonal();
  turn.col(1) = direction.cross(turn.col(0));
}

double RayBundle::SpreadingM(double range_m) const {
  if (!bent) return length_m + range_m;
  const Eigen::Matrix<double, 3, 2> there_m = offset_m + range_m * turn;
  const double section_m2 = std::abs(direction.dot(there_m.col(0).cross(there_m.col(1))));
  return std::max(std::sqrt(section_m2), kSmallestSpreadingM);
}

MirrorSurface::MirrorSurface(const Scene& scene, const std::vector<char>& reflects)
    : scene_(scene),
      reflects_(reflects),
      corners_of_(scene.triangles.size(), kFlat),
      plane_of_(scene.triangles.size(), kNoPlane),
      normal_of_(scene.triangles.size(), 0) {
  for (const Eigen::Vector3f& vertex : scene.vertices_m) {
    largest_coordinate_m_ = std::max(largest_coordinate_m_, double{vertex.cwiseAbs().maxCoeff()});
  }
  // The mesh may have several vertices at one position, one per triangle.
  using Place = std::pair<std::uint16_t, std::array<float, 3>>;
  struct Meeting {
    Eigen::Vector3d normal;
    double angle_rad;
  };
  const auto place = [&](int triangle, int corner) -> Place {
    const Eigen::Vector3f& at = scene.vertices_m[scene.triangles[triangle][corner]];
    return {scene.triangle_material[triangle], {at.x() + 0.0F, at.y() + 0.0F, at.z() + 0.0F}};
  };
  std::map<Place, std::vector<Meeting>> meetings;
  const int triangles = static_cast<int>(scene.triangles.size());
  for (int triangle = 0; triangle < triangles; ++triangle) {
    if (!Reflects(triangle)) continue;
    const auto at = CornersM(scene, triangle);
    for (int corner = 0; corner < 3; ++corner) {
      const Eigen::Vector3d one = at[(corner + 1) % 3] - at[corner];
      const Eigen::Vector3d other = at[(corner + 2) % 3] - at[corner];
      meetings[place(triangle, corner)].push_back(
          {NormalOf(at), std::atan2(one.cross(other).norm(), one.dot(other))});
    }
  }
  // A plane whose values fall on both sides of a rounding step is stored twice. This finds no path twice,
  // because a triangle belongs to one plane only.
  const auto PlaneThrough = [](const Eigen::Vector3d& normal, const Eigen::Vector3d& point_m) -> Plane {
    int largest = 0;
    normal.cwiseAbs().maxCoeff(&largest);
    const double sign = normal[largest] < 0.0 ? -1.0 : 1.0;
    return {sign * normal, sign * normal.dot(point_m)};
  };
  const auto KeyOf = [](const Plane& plane) {
    return std::array<long, 4>{std::lround(1e4 * plane.normal.x()), std::lround(1e4 * plane.normal.y()),
                               std::lround(1e4 * plane.normal.z()), std::lround(1e3 * plane.offset_m)};
  };
  std::map<std::array<long, 4>, std::int32_t> plane_by_key;
  const double crease = std::cos(RadFromDeg(kCreaseDeg));
  for (int triangle = 0; triangle < triangles; ++triangle) {
    if (!Reflects(triangle)) continue;
    const Eigen::Vector3d own = NormalOf(CornersM(scene, triangle));
    normal_of_[triangle] = static_cast<std::int32_t>(flat_normal_.size());
    flat_normal_.push_back(own);
    std::array<Eigen::Vector3f, 3> normals;
    bool flat = true;
    for (int corner = 0; corner < 3; ++corner) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const Meeting& meeting : meetings[place(triangle, corner)]) {
        if (meeting.normal.dot(own) >= crease) sum += meeting.angle_rad * meeting.normal;
      }
      sum = sum.norm() > 0.0 ? sum.normalized() : own;  // a triangle without area has no angles
      flat = flat && (sum - own).norm() < kFlatWithin;
      normals[corner] = sum.cast<float>();
    }
    if (flat) {
      const Plane plane = PlaneThrough(own, CornersM(scene, triangle)[0]);
      const auto [at, is_new] = plane_by_key.emplace(KeyOf(plane), static_cast<std::int32_t>(planes_.size()));
      if (is_new) planes_.push_back(plane);
      plane_of_[triangle] = at->second;
      continue;
    }
    corners_of_[triangle] = static_cast<std::int32_t>(corner_normal_.size());
    corner_normal_.insert(corner_normal_.end(), normals.begin(), normals.end());
  }
}

RayBundle MirrorSurface::Reflected(const RayBundle& bundle, int triangle, double range_m) const {
  const Eigen::Vector3d& own = flat_normal_[normal_of_[triangle]];
  const Eigen::Vector3d& along = bundle.direction;
  RayBundle out = bundle;
  out.point_m = bundle.At(range_m);
  out.length_m += range_m;
  if (!bends()) {  // no mirror bends a bundle: its length is all that SpreadingM needs
    out.direction = Mirrored(along, own);
    return out;
  }
  const auto corner = CornersM(scene_, triangle);
  // Intersections of the neighbouring directions with the plane of the triangle.
  out.offset_m += range_m * bundle.turn;
  const Eigen::RowVector2d off_plane_m = own.transpose() * out.offset_m;
  out.offset_m -= along * off_plane_m / along.dot(own);

  Eigen::Vector3d normal = own;
  Eigen::Matrix3d bend = Eigen::Matrix3d::Zero();  // change of the normal along the surface
  if (corners_of_[triangle] != kFlat) {
    const Eigen::Vector3d twice_area = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d of_corner = corner_normal_[corners_of_[triangle] + i].cast<double>();
      const Eigen::Vector3d& next = corner[(i + 1) % 3];
      // Weight of this corner (1 there, 0 on the opposite side), and its gradient.
      const Eigen::Vector3d gradient =
          twice_area.cross(corner[(i + 2) % 3] - next) / twice_area.squaredNorm();
      sum += std::clamp(gradient.dot(out.point_m - next), 0.0, 1.0) * of_corner;
      slope += of_corner * gradient.transpose();
    }
    const Eigen::Vector3d smooth = sum.normalized();
    if (Mirrored(along, smooth).dot(own) * along.dot(own) < 0.0) {
      normal = smooth;
      bend = (Eigen::Matrix3d::Identity() - smooth * smooth.transpose()) * slope / sum.norm();
      out.bent = true;
    }
  }
  out.direction = Mirrored(along, normal).normalized();
  const Eigen::Matrix<double, 3, 2> tilt = bend * out.offset_m;
  const Eigen::RowVector2d closing = normal.transpose() * bundle.turn + along.transpose() * tilt;
  out.turn = bundle.turn - 2.0 * (normal * closing + along.dot(normal) * tilt);
  return out;
}

}  // namespace sonarcal::sim
