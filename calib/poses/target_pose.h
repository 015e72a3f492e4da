// Where a target is as a sonar sees it, in the coordinates that an image constrains each in its own way:
// range and azimuth are read off directly, yaw and pitch through shape, elevation hardly, roll of a body of
// revolution not at all.
#pragma once

#include <cmath>

#include "core/types/pose.h"

namespace sonarcal::calib {

// The target's frame is that of its scene; its +x axis is its length.
//   direction of +x in the sonar frame = (cos pitch cos yaw, cos pitch sin yaw, sin pitch):
//   yaw from the sonar's X (right) towards its Y (ahead), pitch up.
struct TargetPose {
  double range_m = 1.0;  // of the target's origin
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

  // The pose that shows the same image: reflected in the plane of the beams, which no range or azimuth can
  // see.
  TargetPose Mirrored() const {
    TargetPose mirrored = *this;
    mirrored.elevation_rad = -elevation_rad;
    mirrored.pitch_rad = -pitch_rad;
    return mirrored;
  }
};

}  // namespace sonarcal::calib
