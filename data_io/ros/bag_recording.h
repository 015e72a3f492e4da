// Sonar messages of a ROS bag as a recording, one frame per message, read on request.
//
// A frame's time is the stamp of its message's header, or the time of recording if the stamp is 0. Frames
// have no poses of their own; data_io/bag_trajectory.h reads them from other topics. RecordingInfo::details
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
  std::string topic = {};  // topic of the sonar; may be empty if the bag has only one
  SonarMessageOptions message = {};

  bool operator==(const BagOptions&) const = default;
};

// Throws DataError if the topic is absent or not a sonar's, if none is named and the bag has none or several
// (the message lists them), or if none of the first 100 messages can be read.
std::unique_ptr<RecordingSource> OpenBagRecording(const std::filesystem::path& path,
                                                  const BagOptions& options);

// Opens a bag with a single sonar.
std::unique_ptr<RecordingSource> OpenBag(const std::filesystem::path& path);

}  // namespace sonarcal::data_io
