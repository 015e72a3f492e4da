#include "data_io/scenes/polygon.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::data_io {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Relative to the square of the polygon's size: limit below which an area is zero, and larger limit for areas
// from rounding to float, used if nothing else works.
constexpr double kNoArea = 1e-12;
constexpr double kRoundedArea = 1e-7;

// Twice the area of a triangle, positive if it turns left.
double Turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

class EarClipper {
 public:
  EarClipper(std::vector<Vector2d> points, double size_m)
      : points_(std::move(points)),
        left_(points_.size()),
        no_area_(kNoArea * size_m * size_m),
        rounded_area_(kRoundedArea * size_m * size_m) {
    std::iota(left_.begin(), left_.end(), 0);
  }

  std::optional<std::vector<std::array<int, 3>>> Divide() {
    while (left_.size() > 3) {
      // An ear with a corner exactly on its side may prevent a later division, so it is used only if there is
      // no other.
      if (!ClipEar(-no_area_, no_area_) && !ClipEar(no_area_, no_area_) &&
          !ClipEar(rounded_area_, rounded_area_)) {
        return std::nullopt;
      }
    }
    if (Turn(points_[left_[0]], points_[left_[1]], points_[left_[2]]) < -rounded_area_) return std::nullopt;
    triangles_.push_back({left_[0], left_[1], left_[2]});
    return std::move(triangles_);
  }

 private:
  // Clips the first ear into which no other corner reaches by more than `reach`.
  bool ClipEar(double reach, double no_area) {
    const std::size_t count = left_.size();
    for (std::size_t i = 0; i < count; ++i) {
      const std::array<int, 3> ear = {left_[(i + count - 1) % count], left_[i], left_[(i + 1) % count]};
      const double turn = Turn(points_[ear[0]], points_[ear[1]], points_[ear[2]]);
      if (turn < -no_area || (turn > no_area && HoldsACorner(ear, reach))) continue;
      triangles_.push_back(ear);
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(i));
      return true;
    }
    return false;
  }

  bool HoldsACorner(const std::array<int, 3>& ear, double reach) const {
    const Vector2d& a = points_[ear[0]];
    const Vector2d& b = points_[ear[1]];
    const Vector2d& c = points_[ear[2]];
    return std::any_of(left_.begin(), left_.end(), [&](int place) {
      const Vector2d& point = points_[place];
      if (point == a || point == b || point == c) return false;
      return Turn(a, b, point) > reach && Turn(b, c, point) > reach && Turn(c, a, point) > reach;
    });
  }

  std::vector<Vector2d> points_;
  std::vector<int> left_;  // corners not yet clipped, in order
  double no_area_;
  double rounded_area_;
  std::vector<std::array<int, 3>> triangles_;
};

}  // namespace

std::optional<std::vector<std::array<int, 3>>> DividePolygon(std::span<const Vector3d> corners) {
  SONARCAL_CHECK(corners.size() >= 3, "a polygon of {} corners", corners.size());
  if (corners.size() == 3) return std::vector<std::array<int, 3>>{{0, 1, 2}};
  Vector3d normal = Vector3d::Zero();  // its length is twice the area
  double size_m = 0.0;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Vector3d& next = corners[(i + 1) % corners.size()];
    normal += (corners[i] - corners[0]).cross(next - corners[0]);
    size_m = std::max(size_m, (corners[i] - corners[0]).norm());
  }
  const double no_area = kNoArea * size_m * size_m;
  // Collinear corners have no plane, and any division of them has no area.
  const bool flat = !(normal.norm() > no_area);
  const Vector3d up = flat ? Vector3d::UnitZ() : normal.normalized();
  const Vector3d right = up.unitOrthogonal();
  const Vector3d ahead = up.cross(right);
  std::vector<Vector2d> points;
  for (const Vector3d& corner : corners) {
    const Vector3d from_first = corner - corners[0];
    points.emplace_back(right.dot(from_first), ahead.dot(from_first));
    if (!flat) continue;
    for (const Vector3d& other : corners) {
      if (from_first.cross(other - corners[0]).norm() > no_area) return std::nullopt;  // it crosses itself
    }
    points.back() = Vector2d(from_first.norm(), 0.0);
  }
  return EarClipper(std::move(points), size_m).Divide();
}

}  // namespace sonarcal::data_io
