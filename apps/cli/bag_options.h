// Options for reading a ROS bag (the topic of the sonar, the order of samples) and pictures (the geometry of
// their pixels).
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

// Adds --topic, --sample-order, --mirror and --picture-geometry.
void AddBagOptions(CLI::App& command, BagArguments& arguments);

// Opens a recording of any format; a bag with these options. Throws UsageError if options are given and the
// recording is not a bag.
std::unique_ptr<RecordingSource> OpenWithBagOptions(const std::filesystem::path& named,
                                                    const BagArguments& arguments);

}  // namespace sonarcal::cli
