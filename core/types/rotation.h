// Rotations as files and steps give them.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

namespace sonarcal {

// A quaternion that was written with few digits: nothing where it is not within 1e-3 of unit length, or no
// number.
inline std::optional<Eigen::Quaterniond> UnitQuaternion(const Eigen::Quaterniond& written) {
  constexpr double kOffUnit = 1e-3;
  if (!(std::abs(written.norm() - 1.0) <= kOffUnit)) return std::nullopt;
  return written.normalized();
}

// Turned by a rotation vector about its own axes, rad: rotation * Exp(vector_rad).
inline Eigen::Quaterniond Turned(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& vector_rad) {
  const double angle_rad = vector_rad.norm();
  if (!(angle_rad > 0.0)) return rotation;
  return (rotation * Eigen::AngleAxisd(angle_rad, vector_rad / angle_rad)).normalized();
}

}  // namespace sonarcal
