// What a command is told of a ROS bag: which of its topics is the sonar's, and how its samples lie; and of
// pictures, where their pixels lie.
#pragma once

#include <filesystem>
#include <memory>

#include "apps/cli/command.h"
#include "data_io/ros/bag_recording.h"

namespace sonarcal::cli {

struct BagArguments {
  data_io::BagOptions bag;
  std::filesystem::path picture_geometry;  // empty: none

  bool operator==(const BagArguments&) const = default;
};

// --topic, --sample-order, --mirror and --picture-geometry.
void AddBagOptions(CLI::App& command, BagArguments& arguments);

// A recording of any format; of a bag, what the options say. Throws UsageError where they say something and
// the recording is no bag.
std::unique_ptr<RecordingSource> OpenWithBagOptions(const std::filesystem::path& path,
                                                    const BagArguments& arguments);

}  // namespace sonarcal::cli
