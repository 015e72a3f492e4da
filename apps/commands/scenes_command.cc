#include "apps/commands/scenes_command.h"

#include <fmt/format.h>

#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/given_options.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/commands/commands.h"
#include "core/types/error.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "data_io/scenes/scene_io.h"
#include "sim/paper/paper_values.h"
#include "sim/scenes/scenes.h"
#include "sim/scenes/sonar_presets.h"

namespace sonarcal::commands {
namespace {

using Json = nlohmann::ordered_json;

void WriteViewpoints(const std::filesystem::path& file, const std::vector<Pose>& viewpoints) {
  std::vector<data_io::TimedPose> poses;
  for (const Pose& pose : viewpoints) {
    poses.push_back({.time_s = static_cast<double>(poses.size()), .world_from_sonar = pose});
  }
  data_io::WritePoses(file, poses);
}

cli::ExitStatus ListScenes(const ScenesOptions& options) {
  Json json = Json::array();
  std::string text;
  for (const sim::Environment* environment : ChosenEnvironments(options.only)) {
    const Scene scene = environment->make(options.environment);
    const std::size_t viewpoints = environment->viewpoints().size();
    json.push_back({{"name", environment->name},
                    {"description", environment->description},
                    {"triangles", scene.triangles.size()},
                    {"materials", scene.material_names},
                    {"viewpoints", viewpoints}});
    text += fmt::format("{:12} {:7} triangles, {} viewpoints  {}\n", environment->name,
                        scene.triangles.size(), viewpoints, environment->description);
  }
  if (options.common.json) {
    cli::PrintJson({{"scenes", json}});
  } else {
    cli::PrintResult(text);
  }
  return cli::ExitStatus::kDone;
}

}  // namespace

// Each material has its own name, so that a file can change one of them.
ParameterSet EnvironmentParameters() {
  std::vector<std::string> names = sim::EnvironmentMaterials();
  names.emplace_back("default");  // for other materials of a scene, and for STL and PLY, which name none
  return sim::PaperValues(sim::FindSonarPreset("p900-45").sonar, names);
}

std::vector<const sim::Environment*> ChosenEnvironments(const std::vector<std::string>& only) {
  std::vector<const sim::Environment*> chosen;
  for (const std::string& name : only) chosen.push_back(&sim::FindEnvironment(name));
  if (!only.empty()) return chosen;
  for (const sim::Environment& environment : sim::Environments()) chosen.push_back(&environment);
  return chosen;
}

void AddEnvironmentOptions(CLI::App& command, std::vector<std::string>& only,
                           sim::EnvironmentOptions& options) {
  command.add_option("--only", only, "Names of scenes, listed by sonarcal scenes --list (default: all)")
      ->delimiter(',')
      ->type_name("NAME,NAME")
      ->allow_extra_args(false);
  command
      .add_option("--edge", options.max_edge_m,
                  "Longest side of the meshes' cells, metres; 0 for each scene's own resolution")
      ->type_name("M")
      ->check(cli::Within(0.0, 1e6));
  cli::AddOption(command, {.name = "seed", .help = "Seed of the seabed's relief"}, options.seed);
  command.add_flag("--surface", options.surface, "Add the water's surface to the tank");
}

cli::ExitStatus RunScenes(ScenesOptions options) {
  options.environment.size =
      options.text_sizes ? sim::SizeVariant::kAlternative : sim::SizeVariant::kStandard;
  if (options.list) return ListScenes(options);
  if (options.out.empty()) throw UsageError("--out is required, except with --list");
  const std::vector<const sim::Environment*> chosen = ChosenEnvironments(options.only);

  cli::RunOutput output(options.out, "scenes", options.common.force);
  std::vector<std::string> files;
  const auto file = [&](const std::string& name) {
    files.push_back(name);
    return output / name;
  };
  const sim::Environment* with_poses = nullptr;  // poses_N.json are its sets
  for (const sim::Environment* environment : chosen) {
    data_io::WriteGltf(environment->make(options.environment),
                       file(fmt::format("{}.gltf", environment->name)));
    WriteViewpoints(file(fmt::format("poses_{}.json", environment->name)), environment->viewpoints());
    if (environment->pose_sets > 0) with_poses = environment;
  }
  data_io::WriteParameters(file("params.json"), EnvironmentParameters());
  for (int set = 1; with_poses != nullptr && set <= with_poses->pose_sets; ++set) {
    WriteViewpoints(file(fmt::format("poses_{}.json", set)), with_poses->poses(set));
  }
  Json names = Json::array();
  for (const sim::Environment* environment : chosen) names.push_back(environment->name);
  cli::WriteProvenance(output.staging(), {.command = "scenes",
                                          .configuration = {{"out", options.out.string()},
                                                            {"scenes", names},
                                                            {"text_sizes", options.text_sizes},
                                                            {"surface", options.environment.surface},
                                                            {"bed", options.environment.bed},
                                                            {"edge_m", options.environment.max_edge_m}},
                                          .seed = options.environment.seed});
  output.Commit();

  if (options.common.json) {
    cli::PrintJson({{"folder", output.final_path().string()}, {"files", files}});
    return cli::ExitStatus::kDone;
  }
  const std::string folder = options.out.string();
  cli::PrintResult(
      fmt::format("{0}: {1}\nnext: sonarcal simulate --scene {0}/{2}.gltf --sonar p900-45 --params "
                  "{0}/params.json --poses "
                  "{0}/poses_{3}.json --out simulated\n",
                  folder, fmt::join(files, ", "), with_poses ? with_poses->name : chosen.front()->name,
                  with_poses ? "1" : chosen.front()->name));
  return cli::ExitStatus::kDone;
}

void SetupScenes(CLI::App& app) {
  auto options = std::make_shared<ScenesOptions>();
  CLI::App* command = cli::AddCommand(app, "scenes", "Writes the paper's scenes, with parameters and poses");
  cli::AddOutFolder(*command, options->out, options->common,
                    "Folder for scenes, parameters and poses; required without --list");
  command->add_flag("--list", options->list, "List the scenes with their number of triangles; write nothing");
  AddEnvironmentOptions(*command, options->only, options->environment);
  command->add_flag("--bed", options->environment.bed,
                    "Put a flat bed below mock-up, bridge pier and jacket, which stand free otherwise");
  command->add_flag(
      "--text-sizes", options->text_sizes,
      "Sizes of the paper's text (15 x 10 x 2 m, 1 m cube), not of its Table 5 (12 x 10 x 1.5 m, "
      "1 x 1 x 1.5 m)");
  cli::OnRun(command, options->common, [command, options] {
    if (options->list) cli::RefuseGiven(*command, {"--out", "--force"}, "with --list, which writes nothing");
    return RunScenes(*options);
  });
}

}  // namespace sonarcal::commands
