// `sonarcal simulate`: simulates a recording of a sonar in a scene from given poses.
//
// Writes the recording folder (data_io/recordings/recording_io.h), params.json with the used parameters, and
// on request fan_NNNN.png (frames as fans, in metres) and depth images. A depth image holds the distance
// along each ray to its first intersection within the range window of the sonar, on the grid of cast rays
// (sim/rays/ray_fan.h). Row 0 is the highest elevation, column 0 the leftmost azimuth. Files:
//
//   range_NNNN.tiff          metres, 0 for nothing
//   depth_NNNN.png           16 bits, whole millimetres, 0 for nothing, 65535 for that range and more
//   depth_view_NNNN.png      for display: near is bright, white is nothing
//
// Frames are rendered and written one at a time. SIGINT and SIGTERM leave a recording of the finished frames
// (status 130). A killed run leaves them complete in .NAME.unfinished. `resume` makes the missing frames. The
// result equals that of an uninterrupted run, byte by byte.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/scene_option.h"
#include "apps/workflow/simulate.h"
#include "core/types/frame_list.h"

namespace sonarcal::commands {

struct SimulateCommandOptions {
  cli::CommonOptions common;
  std::filesystem::path scene;
  cli::SceneFormat scene_format;
  std::string sonar;  // name of a preset, or file
  std::filesystem::path params;
  std::filesystem::path poses;  // recording, or file of poses
  FrameList frames;             // consecutive poses to simulate; empty: all
  std::filesystem::path out;
  workflow::SimulateOptions simulate;
  bool fan = false;
  bool depth = false;
  bool resume = false;  // continues an interrupted run of the same command from its remains in `out`
};

cli::ExitStatus RunSimulate(const SimulateCommandOptions& options);

}  // namespace sonarcal::commands
