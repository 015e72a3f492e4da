// A sonar's messages in a ROS bag as a recording, one frame a message, read when asked for.
//
// A frame's time is the stamp of its message's header, or where that is 0 the time it was recorded. Frames
// have no poses of their own: data_io/bag_trajectory.h reads them from other topics. RecordingInfo::details
// lists the bag's topics.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/types/recording.h"
#include "data_io/ros/bag.h"
#include "data_io/ros/sonar_message.h"

namespace sonarcal::data_io {

struct BagOptions {
  std::string topic = {};  // of the sonar; empty where the bag has only one
  SonarMessageOptions message = {};

  bool operator==(const BagOptions&) const = default;
};

// Throws DataError where the topic is not there or not a sonar's, where none is named and the bag has none or
// several (the sentence lists them), or the first message is damaged.
std::unique_ptr<RecordingSource> OpenBagRecording(const std::filesystem::path& path,
                                                  const BagOptions& options);

// The same for a bag of one sonar.
std::unique_ptr<RecordingSource> OpenBag(const std::filesystem::path& path);

}  // namespace sonarcal::data_io
