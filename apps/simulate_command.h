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

#include "apps/command.h"
#include "apps/ray_options.h"
#include "apps/scene_option.h"
#include "apps/simulate_recording.h"
#include "core/types/parameters.h"

namespace sonarcal {

struct SimulateOptions {
  CommonOptions common;
  std::filesystem::path scene;
  SceneFormat scene_format;
  std::string sonar;  // name of a preset, or file
  std::filesystem::path params;
  std::filesystem::path poses;  // recording, or file of poses
  std::filesystem::path out;
  std::optional<EchoModel> model;  // default: the parameters'
  RayOptions rays;
  int bits = 8;        // 8, 12 or 16
  bool noise = false;  // coherent: unless `expected`
  bool expected = false;
  bool frozen_speckle = false;
  int ghost_order = 1;  // of paths by mirrors: 1 or 2
  // Azimuth cast beyond the outer beams; default: none for paper, three beam widths for acoustic and
  // coherent.
  std::optional<double> margin_deg;
  std::optional<std::uint64_t> seed;  // default: 1
  bool fan = false;
  bool depth = false;
  bool resume = false;  // go on with what an interrupted run of the same command left in `out`
};

// What the options come to for a sonar and parameters.
struct ResolvedSimulation {
  ParameterSet parameters;  // their model that of the options, where those name one
  SimulationOptions simulation;
  std::string water_note;  // a sentence where the choice of water needs saying; else empty
};

// Throws UsageError for options that do not go together.
ResolvedSimulation ResolveSimulation(const SimulateOptions& options, const SonarChoice& choice,
                                     ParameterSet parameters);

// The words of a run that a user should not miss.
std::vector<std::string> SimulationCaveats(const SimulateOptions& options, const Simulator& simulator,
                                           const ResolvedSimulation& resolved);

// What the command line may say of the options.
void AddSimulateOptions(CLI::App* command, SimulateOptions* options);

ExitStatus RunSimulate(const SimulateOptions& options);

}  // namespace sonarcal
