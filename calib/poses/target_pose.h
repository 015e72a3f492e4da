// Pose of a target relative to a sonar, in coordinates that an image constrains differently. Range and
// azimuth are visible directly, yaw, pitch and roll through the shape, elevation hardly, and the roll of a
// body of revolution not at all.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/types/pose.h"

namespace sonarcal::calib {

// The frame of the target is that of its scene; its +x axis is its length.
//
//   direction of +x in the sonar frame = (cos pitch cos yaw, cos pitch sin yaw, sin pitch):
//   yaw from the sonar's X (right) towards its Y (ahead), pitch up.
struct TargetPose {
  double range_m = 1.0;  // to the origin of the target
  double azimuth_rad = 0.0;
  double elevation_rad = 0.0;
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
  double roll_rad = 0.0;  // about the target's +x

  static TargetPose Of(const Pose& sonar_from_target) {
    const Eigen::Vector3d& p = sonar_from_target.position_m;
    const Eigen::Matrix3d r = sonar_from_target.rotation.toRotationMatrix();
    // Rz(yaw) Ry(-pitch) Rx(roll) has the first column (cos p cos y, cos p sin y, sin p) and the third row
    // (sin p, cos p sin r, cos p cos r).
    return {.range_m = p.norm(),
            .azimuth_rad = std::atan2(p.x(), p.y()),
            .elevation_rad = std::atan2(p.z(), std::hypot(p.x(), p.y())),
            .yaw_rad = std::atan2(r(1, 0), r(0, 0)),
            .pitch_rad = std::asin(std::clamp(r(2, 0), -1.0, 1.0)),
            .roll_rad = std::atan2(r(2, 1), r(2, 2))};
  }

  Pose SonarFromTarget() const {
    const Eigen::Quaterniond rotation = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
                                        Eigen::AngleAxisd(-pitch_rad, Eigen::Vector3d::UnitY()) *
                                        Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX());
    return {rotation, range_m * Eigen::Vector3d(std::sin(azimuth_rad) * std::cos(elevation_rad),
                                                std::cos(azimuth_rad) * std::cos(elevation_rad),
                                                std::sin(elevation_rad))};
  }

  // With the target's frame as world.
  Pose WorldFromSonar() const { return SonarFromTarget().Inverse(); }

  // Returns the pose with the same image if the target is symmetric in its x-y plane: its reflection in the
  // plane of the beams, which range and azimuth do not distinguish.
  TargetPose Mirrored() const {
    TargetPose mirrored = *this;
    mirrored.elevation_rad = -elevation_rad;
    mirrored.pitch_rad = -pitch_rad;
    mirrored.roll_rad = -roll_rad;
    return mirrored;
  }
};

}  // namespace sonarcal::calib
