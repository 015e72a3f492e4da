#include "apps/scenes_command.h"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/provenance.h"
#include "apps/run_output.h"
#include "data_io/parameters_io.h"
#include "data_io/pose_io.h"
#include "data_io/scene_io.h"
#include "sim/scenes.h"

namespace sonarcal {
namespace {

constexpr int kDataSets = 3;

// The paper's Table 4 for every material, each under its own name so that a file can change one. The paper
// gives no dB_min and dB_max: with these the floor shows faintly and the mock-up brightly. Errors of half a
// range resolution and half a beam.
ParameterSet ParametersToStartFrom() {
  ParameterSet parameters;
  parameters.display = {.db_min = 150.0, .db_max = 153.0};
  for (const char* material : {"floor", "wall", "mockup", "surface"}) parameters.materials[material];
  parameters.jitter.sigma_range_m = 0.0127;
  parameters.jitter.sigma_azimuth_deg = 0.5;
  return parameters;
}

}  // namespace

ExitStatus RunScenes(const ScenesOptions& options) {
  const PaperSize size = options.text_sizes ? PaperSize::kText : PaperSize::kTable5;
  PaperTankOptions tank = PaperTankOfPaper(size);
  tank.tank.surface = options.surface;

  RunOutput output(options.out);
  std::vector<std::string> files;
  const auto file = [&](const std::string& name) {
    files.push_back(name);
    return output / name;
  };
  WriteGltf(MakePaperTank(tank), file("tank.gltf"));
  WriteGltf(MakeMockup(tank.mockup), file("mockup.gltf"));
  WriteParameters(file("params.json"), ParametersToStartFrom());
  for (int set = 1; set <= kDataSets; ++set) {
    std::vector<TimedPose> poses;
    for (const Pose& pose : PaperTankPoses(set)) {
      poses.push_back({.time_s = static_cast<double>(poses.size()), .world_from_sonar = pose});
    }
    WritePoses(file(fmt::format("poses_{}.json", set)), poses);
  }
  WriteProvenance(output.staging(), {.command = "scenes",
                                     .configuration = {{"out", options.out.string()},
                                                       {"text_sizes", options.text_sizes},
                                                       {"surface", options.surface}}});
  output.Commit();

  if (options.common.json) {
    PrintJson({{"folder", output.final_path().string()}, {"files", files}});
    return ExitStatus::kDone;
  }
  const std::string folder = options.out.string();
  PrintResult(
      fmt::format("{}: {}\nnext: sonarcal simulate --scene {}/tank.gltf --sonar p900-45 --params "
                  "{}/params.json --poses {}/poses_1.json --out simulated\n",
                  folder, fmt::join(files, ", "), folder, folder, folder));
  return ExitStatus::kDone;
}

void SetupScenes(CLI::App& app) {
  auto options = std::make_shared<ScenesOptions>();
  CLI::App* command = AddCommand(
      app, "scenes", "Writes the paper's tank and mock-up, with parameters and poses, to simulate");
  command->add_option("--out", options->out, "Folder for scenes, parameters and poses")
      ->type_name("DIR")
      ->required();
  command->add_flag(
      "--text-sizes", options->text_sizes,
      "Sizes of the paper's text (15 x 10 x 2 m, 1 m cube), not of its Table 5 (12 x 10 x 1.5 m, "
      "1 x 1 x 1.5 m)");
  command->add_flag("--surface", options->surface, "Add the water's surface to the tank");
  OnRun(command, options->common, [options] { return RunScenes(*options); });
}

}  // namespace sonarcal
