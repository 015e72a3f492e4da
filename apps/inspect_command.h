// `sonarcal inspect FILE...`: what a file holds - sensor, window, beams, frames, gain, scale, quirks.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/bag_options.h"
#include "apps/command.h"
#include "core/types/recording.h"

namespace sonarcal {

struct InspectOptions {
  CommonOptions common;
  std::vector<std::filesystem::path> files;
  BagArguments bag;
};

// Prints a page for each file. A file that can't be read costs its sentence on stderr and status 1, and the
// next is read all the same.
ExitStatus RunInspect(const InspectOptions& options);

// The page of one recording, for people and for programs. Both read the first frame's pixels for its
// statistics, and say so where they are damaged.
std::string DescribeRecording(const RecordingSource& recording);
nlohmann::ordered_json RecordingToJson(const RecordingSource& recording);

}  // namespace sonarcal
