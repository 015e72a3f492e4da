// Rigid transform. Its name states the direction: `world_from_sonar` converts sonar coordinates to world
// coordinates.
//
// World: metres, Z up. Sonar frame: X right, Y forward (broadside), Z up.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace sonarcal {

struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // unit length
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point_m) const { return rotation * point_m + position_m; }

  Pose operator*(const Pose& other) const {
    return {rotation * other.rotation, rotation * other.position_m + position_m};
  }

  Pose Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {inverse, -(inverse * position_m)};
  }
};

// True for the transform that changes nothing.
inline bool IsIdentity(const Pose& pose) {
  return pose.position_m.isZero(0.0) && pose.rotation.vec().isZero(0.0);
}

// True if two poses agree within 1 mm and 1 mrad.
inline bool IsSamePose(const Pose& a, const Pose& b) {
  constexpr double kSameM = 1e-3;
  constexpr double kSameRad = 1e-3;
  return (a.position_m - b.position_m).norm() <= kSameM && a.rotation.angularDistance(b.rotation) <= kSameRad;
}

// Rotations about the sonar's own axes, in this order: yaw about Z (positive to the left), pitch about the
// new X (positive looks up), roll about the new Y (positive lowers the right side).
inline Eigen::Quaterniond RotationFromYawPitchRoll(double yaw_rad, double pitch_rad, double roll_rad) {
  return Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitY());
}

// Inverse of RotationFromYawPitchRoll: (yaw, pitch, roll), pitch within +-90 degrees. At +-90 degrees many
// pairs of yaw and roll give the same rotation: roll is then 0.
inline Eigen::Vector3d YawPitchRollFromRotation(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d r = rotation.toRotationMatrix();
  // R = Rz(yaw) Rx(pitch) Ry(roll) has the third row (-cos p sin r, sin p, cos p cos r) and the second column
  // (-sin y cos p, cos y cos p, sin p).
  constexpr double kMinCosine = 1e-6;  // of pitch; below it, rounding hides yaw and roll
  if (std::hypot(r(0, 1), r(1, 1)) < kMinCosine) {
    // For roll 0 the first column is (cos y, sin y, 0).
    return {std::atan2(r(1, 0), r(0, 0)), std::copysign(0.5 * std::numbers::pi, r(2, 1)), 0.0};
  }
  return {std::atan2(-r(0, 1), r(1, 1)), std::asin(std::clamp(r(2, 1), -1.0, 1.0)),
          std::atan2(-r(2, 0), r(2, 2))};
}

}  // namespace sonarcal
