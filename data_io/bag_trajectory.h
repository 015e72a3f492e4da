// Trajectory of a body from the messages of a ROS bag:
//
//   nav_msgs/Odometry, geometry_msgs/PoseStamped   world_from_body, one pose per message. The world is the
//                                                  frame of the header.
//   tf2_msgs/TFMessage, tf/tfMessage               Chain of transforms from a world frame to a body frame,
//                                                  including those of /tf_static. One pose for each time at
//                                                  which a transform of the chain was sent; the others are
//                                                  interpolated.
//
// ROS worlds have Z up, bodies X forward and Y to the left (REP 103). A sonar on a body therefore needs a
// mount (data_io/trajectory_io.h), even if the body's frame is named after the sonar. The time of a pose is
// the stamp of its header, or the time of recording if the stamp is 0. If several poses have one time, the
// first is used.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "data_io/trajectory_io.h"

namespace sonarcal::data_io {

struct BagPoseOptions {
  std::string topic = {};        // "/odom", "/tf"
  std::string world_frame = {};  // for transforms only; a leading '/' is ignored
  std::string body_frame = {};   // as `world_frame`
  double most_gap_s = 1.0;       // max time between two interpolated transforms
};

// At least one pose, in ascending order of time. Throws DataError if the topic is absent or has another type,
// a message is damaged, the frames of poses change, or no chain of transforms leads from one frame to the
// other.
std::vector<TrajectoryPose> ReadBagTrajectory(const std::filesystem::path& path,
                                              const BagPoseOptions& options);

}  // namespace sonarcal::data_io
