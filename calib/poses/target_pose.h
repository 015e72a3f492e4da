// Pose of a target relative to a sonar, in coordinates that an image constrains differently. Range and
// azimuth are visible directly, yaw and pitch through the shape, elevation hardly, and the roll of a body of
// revolution not at all.
#pragma once

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

  Pose SonarFromTarget() const {
    const Eigen::Quaterniond rotation = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
                                        Eigen::AngleAxisd(-pitch_rad, Eigen::Vector3d::UnitY());
    return {rotation, range_m * Eigen::Vector3d(std::sin(azimuth_rad) * std::cos(elevation_rad),
                                                std::cos(azimuth_rad) * std::cos(elevation_rad),
                                                std::sin(elevation_rad))};
  }

  // With the target's frame as world.
  Pose WorldFromSonar() const { return SonarFromTarget().Inverse(); }

  // Returns the pose with the same image: its reflection in the plane of the beams, which range and azimuth
  // do not distinguish.
  TargetPose Mirrored() const {
    TargetPose mirrored = *this;
    mirrored.elevation_rad = -elevation_rad;
    mirrored.pitch_rad = -pitch_rad;
    return mirrored;
  }
};

}  // namespace sonarcal::calib
