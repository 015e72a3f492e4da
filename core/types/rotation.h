// Rotations from files and from optimisation steps.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

namespace sonarcal {

// Normalises a quaternion that was written with few digits. Returns nothing if its length differs from 1 by
// more than 1e-3, or is not a number.
inline std::optional<Eigen::Quaterniond> UnitQuaternion(const Eigen::Quaterniond& written) {
  constexpr double kOffUnit = 1e-3;
  if (!(std::abs(written.norm() - 1.0) <= kOffUnit)) return std::nullopt;
  return written.normalized();
}

// Rotation followed by a rotation vector about its own axes, rad: rotation * Exp(vector_rad).
inline Eigen::Quaterniond Turned(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& vector_rad) {
  const double angle_rad = vector_rad.norm();
  if (!(angle_rad > 0.0)) return rotation;
  return (rotation * Eigen::AngleAxisd(angle_rad, vector_rad / angle_rad)).normalized();
}

}  // namespace sonarcal
