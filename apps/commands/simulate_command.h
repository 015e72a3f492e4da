// `sonarcal simulate`: a recording of what a sonar would see of a scene, from given poses.
//
// Written: the recording folder (data_io/recordings/recording_io.h), params.json with the parameters as used,
// and where asked for fan_NNNN.png (the frames laid out in metres) and the depth image: the distance along
// each ray to what it met first within the sonar's range window, row 0 the highest elevation, column 0 the
// leftmost azimuth, on the grid of rays that was cast (sim/rays/ray_fan.h). As range_NNNN.tiff (metres, 0 for
// nothing), depth_NNNN.png (16 bits, whole millimetres, 0 for nothing, 65535 for that and more), and for eyes
// depth_view_NNNN.png (near is bright, white is nothing).
//
// Frames are rendered and written one at a time. SIGINT and SIGTERM leave a recording of the frames finished
// so far (status 130); a run that was killed leaves them aside, whole, in .NAME.unfinished. With `resume` the
// rest are made, and the recording is that of a run never interrupted, byte by byte.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/scene_option.h"
#include "apps/workflow/simulate.h"

namespace sonarcal::commands {

struct SimulateCommandOptions {
  cli::CommonOptions common;
  std::filesystem::path scene;
  cli::SceneFormat scene_format;
  std::string sonar;  // name of a preset, or file
  std::filesystem::path params;
  std::filesystem::path poses;  // recording, or file of poses
  std::filesystem::path out;
  workflow::SimulateOptions simulate;
  bool fan = false;
  bool depth = false;
  bool resume = false;  // go on with what an interrupted run of the same command left in `out`
};

cli::ExitStatus RunSimulate(const SimulateCommandOptions& options);

}  // namespace sonarcal::commands
