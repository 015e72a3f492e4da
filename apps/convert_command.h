// `sonarcal convert FILE --out REC`: any format that can be read, written as a recording folder; with the
// sonar's poses, where a trajectory tells them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/bag_options.h"
#include "apps/command.h"
#include "data_io/trajectory_io.h"

namespace sonarcal {

struct ConvertOptions {
  CommonOptions common;
  std::filesystem::path file;
  std::filesystem::path out;
  std::string frames;                                 // "A:B", see apps/frame_range.h; empty for all
  std::filesystem::path trajectory;                   // empty: poses as recorded
  std::optional<TrajectoryFormat> trajectory_format;  // absent: told by its first lines
  BagArguments bag;
  std::string pose_topic;       // of a ROS bag, in place of a trajectory
  std::string pose_frames;      // "WORLD:BODY", where the topic has transforms
  std::filesystem::path mount;  // empty: the trajectory is the sonar's own
  double time_offset_s = 0.0;   // added to frame times to look them up
  bool salvage = false;         // leave out frames that cannot be read
  double most_gap_s = 1.0;      // between poses that are interpolated
};

ExitStatus RunConvert(const ConvertOptions& options);

}  // namespace sonarcal
