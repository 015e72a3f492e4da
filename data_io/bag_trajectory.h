// Where a body was over time, from the messages of a ROS bag:
//
//   nav_msgs/Odometry, geometry_msgs/PoseStamped   world_from_body, one pose a message; the world is the
//   header's
//                                                  frame
//   tf2_msgs/TFMessage, tf/tfMessage               the chain of transforms from a world's frame down to a
//   body's,
//                                                  those of /tf_static included; at every time at which one
//                                                  of the chain was sent, the others interpolated
//
// ROS worlds have Z up, bodies X ahead and Y to the left (REP 103): a sonar on one needs a mount
// (data_io/trajectory_io.h), also where the body's frame is named for the sonar. A pose's time is the stamp
// of its header, or where that is 0 the time it was recorded. Of poses of one time the first counts.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "data_io/trajectory_io.h"

namespace sonarcal::data_io {

struct BagPoseOptions {
  std::string topic = {};        // "/odom", "/tf"
  std::string world_frame = {};  // of transforms only; a leading '/' is of no matter
  std::string body_frame = {};   // likewise
  double most_gap_s = 1.0;       // between two transforms that are interpolated
};

// At least one pose, by increasing time. Throws DataError where the topic is not there or of another type, a
// message is damaged, the frames of poses change, or no chain of transforms leads from one frame to the
// other.
std::vector<TrajectoryPose> ReadBagTrajectory(const std::filesystem::path& bag,
                                              const BagPoseOptions& options);

}  // namespace sonarcal::data_io
