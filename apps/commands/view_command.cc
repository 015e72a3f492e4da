#include "apps/commands/view_command.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <iostream>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/given_options.h"
#include "apps/cli/interruption.h"
#include "apps/cli/run_output.h"
#include "apps/cli/sonar_option.h"
#include "apps/commands/commands.h"
#include "apps/commands/scenes_command.h"
#include "apps/view/view_api.h"
#include "apps/view/view_server.h"
#include "apps/workflow/simulate.h"
#include "core/types/error.h"
#include "data_io/json/json_reader.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/locked_recording.h"
#include "sim/scenes/environments.h"

namespace sonarcal::commands {
namespace {

// Pose with the centre of the scene in the middle of the range window, 25 degrees below the sonar.
Pose PlaceBeforeScene(const Scene& scene, const PolarAxes& axes) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex_m : scene.vertices_m) box.extend(vertex_m);
  if (box.isEmpty()) return {};
  const Eigen::Vector3d middle_m = box.center().cast<double>();
  const double distance_m = 0.5 * (axes.range_min_m + axes.range_max_m);
  const double down_rad = RadFromDeg(25.0);
  const Eigen::Vector3d from_m =
      middle_m + distance_m * Eigen::Vector3d(0.0, -std::cos(down_rad), std::sin(down_rad));
  return sim::LookingAt(from_m, middle_m);
}

bool HasPoses(const RecordingSource& recording) {
  for (int frame = 0; frame < recording.frame_count(); ++frame) {
    if (!recording.frame_info(frame).world_from_sonar) return false;
  }
  return true;
}

void SetPoses(const ViewOptions& options, view::ViewSetup& setup) {
  if (!options.poses.empty()) {
    setup.poses = data_io::WithMotion(data_io::ReadPosesOrRecording(options.poses), setup.sonar.pings);
  } else if (setup.real && HasPoses(*setup.real)) {
    setup.poses = data_io::PosesOfRecording(*setup.real);
  } else {
    setup.poses_given = false;
    setup.poses.assign(setup.real ? static_cast<std::size_t>(setup.real->frame_count()) : 1,
                       {{}, PlaceBeforeScene(setup.scene, setup.sonar.axes)});
    for (std::size_t i = 0; setup.real && i < setup.poses.size(); ++i) {
      setup.poses[i].time_s = setup.real->frame_info(static_cast<int>(i)).time_s;
    }
    cli::PrintNote(
        options.common,
        setup.real ? "the recording has no poses: the sonar is placed in front of the scene, move it by hand"
                   : "no poses are given: the sonar is placed in front of the scene, move it by hand");
  }
  const int count = static_cast<int>(setup.poses.size());
  if (setup.real && setup.real->frame_count() != count) {
    throw DataError("{} has {} frames and {} has {} poses, expected as many", setup.real->info().source,
                    setup.real->frame_count(), options.poses.string(), count);
  }
}

// Names of the materials in a file of parameters that have no curve.
std::vector<std::string> MaterialsWithoutCurve(const std::filesystem::path& params) {
  std::vector<std::string> names;
  const data_io::JsonReader json = data_io::JsonReader::FromFile(params);
  for (const auto& [name, material] : json.At("materials").Members()) {
    if (!material.Find("gsab")) names.push_back(name);
  }
  return names;
}

// A material without a curve starts at the centre of its prior. If all have curves, no prior need be known.
ParameterSet ReadParametersToShow(const ViewOptions& options) {
  const std::vector<std::string> without_curve = MaterialsWithoutCurve(options.params);
  if (without_curve.empty()) return data_io::ReadParameters(options.params);
  ParameterSet parameters = data_io::ReadStartParameters(options.params, options.materials.Known());
  for (const std::string& name : without_curve) {
    cli::PrintNote(options.common,
                   fmt::format("material '{}' starts at the centre of the prior of {}; a prior is no value",
                               name, parameters.materials.at(name).prior));
  }
  return parameters;
}

// Refuses a --material that a fit cannot use.
void SetMaterials(const ViewOptions& options, view::ViewSetup& setup) {
  setup.materials = options.materials;
  if (options.materials.material.empty()) return;
  calib::FitConfig config;
  workflow::AddMaterialPriors(options.materials, setup.parameters, setup.scene, config);
}

std::string SceneWords(const cli::SceneFormat& format) {
  const nlohmann::ordered_json json = cli::SceneFormatJson(format);
  std::string words;
  if (json.contains("scene_unit")) words += " --scene-unit " + json["scene_unit"].get<std::string>();
  if (json.contains("scene_up")) words += " --scene-up " + json["scene_up"].get<std::string>();
  return words;
}

// Opens the address with the desktop's program, as one word and without a shell.
void OpenBrowser(const std::string& url) {
  std::string program = "xdg-open";
  std::string address = url;
  char* const arguments[] = {program.data(), address.data(), nullptr};
  // A browser must not inherit that this program blocks and ignores signals.
  sigset_t none;
  sigset_t usual;
  sigemptyset(&none);
  sigemptyset(&usual);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ}) sigaddset(&usual, signal);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &usual);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  pid_t child = 0;
  const int fault = posix_spawnp(&child, "xdg-open", nullptr, &attributes, arguments, environ);
  posix_spawnattr_destroy(&attributes);
  if (fault != 0) {
    cli::PrintError("xdg-open was not found: open the address by hand");
    return;
  }
  std::thread([child] { waitpid(child, nullptr, 0); }).detach();
}

}  // namespace

view::ViewSetup SetUpView(const ViewOptions& options) {
  view::ViewSetup setup;
  if (!options.real.empty())
    setup.real = std::make_shared<const data_io::LockedRecording>(data_io::OpenRecording(options.real));
  if (options.sonar.empty() && !setup.real) throw UsageError("--sonar is required without --real");
  setup.sonar_argument = options.sonar.empty() ? options.real.string() : options.sonar;
  const workflow::SonarChoice choice = workflow::ChooseSonar(setup.sonar_argument);
  setup.sonar = choice.sonar;
  if (setup.real) {
    std::string why;
    if (!setup.real->info().sonar.axes.Matches(setup.sonar.axes, &why)) {
      throw DataError("{}: its images are not those of the sonar {}: {}; leave --sonar out to take its own",
                      options.real.string(), options.sonar, why);
    }
    if (setup.real->info().scale.quantity != Quantity::kGrey) {
      throw DataError("{}: the images hold {}, expected grey levels", options.real.string(),
                      ToString(setup.real->info().scale.quantity));
    }
  }
  setup.parameters = options.params.empty() ? EnvironmentParameters() : ReadParametersToShow(options);
  if (options.model) setup.parameters.model = *options.model;
  if (setup.parameters.model == EchoModel::kCoherent) {
    throw UsageError(
        "the model is 'coherent', which is too slow to follow a slider, expected --model paper or --model "
        "acoustic");
  }
  workflow::CheckRayWeight(options.rays.ray_weight, setup.parameters.model);
  const workflow::WaterChoice water = workflow::ChooseWater(setup.parameters, choice.water);
  if (!water.note.empty()) cli::PrintNote(options.common, water.note);
  setup.water = water.water;
  setup.scene = cli::ReadSceneFile(options.scene, options.scene_format, options.common);
  setup.scene_path = options.scene.string();
  setup.scene_words = SceneWords(options.scene_format);
  if (options.params.empty()) {
    cli::PrintNote(options.common, "no parameters are given: those of the built-in scenes are used");
    // For materials that are not in the built-in scenes.
    setup.parameters.materials.try_emplace("default");
  }
  for (const std::string& name : setup.scene.material_names) setup.parameters.Material(name);
  SetMaterials(options, setup);
  SetPoses(options, setup);
  setup.rays = options.rays;
  setup.margin_deg = options.margin_deg;
  setup.ghost_order = options.ghost_order;
  setup.compare = options.comparison.For(setup.sonar.axes);
  setup.inputs = cli::OptionFiles(options);
  setup.inputs.insert(setup.inputs.begin(), {options.scene, cli::SonarFile(options.sonar), options.params,
                                             options.poses, options.real});
  return setup;
}

cli::ExitStatus RunView(const ViewOptions& options) {
  const workflow::ThreadLimit threads(options.rays.threads);
  if (!options.out.empty()) cli::CheckOutFolder(options.out, "view", options.common.force);
  view::ViewSession session(SetUpView(options));
  view::ViewApi api(session, options.out, options.common.force);
  view::ViewServer server(api, options.port);
  const cli::Interruption interruption;  // before this point there is nothing to stop
  server.Start();
  if (options.common.json) {
    cli::PrintJson(
        {{"url", server.url()}, {"host", "127.0.0.1"}, {"port", server.port()}, {"token", server.token()}});
  } else {
    cli::PrintResult(server.url() + "\n");
  }
  std::cout.flush();  // sends the address to a waiting reader at once
  cli::PrintNote(options.common, "open this address in a browser of this machine; Ctrl-C ends");
  if (options.open) OpenBrowser(server.url());
  while (!interruption.asked()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  server.Stop();
  cli::PrintNote(options.common, "ended");
  return cli::ExitStatus::kDone;
}

void SetupView(CLI::App& app) {
  auto options = std::make_shared<ViewOptions>();
  CLI::App* command =
      cli::AddCommand(app, "view", "Shows a scene and its sonar image live in a browser, with sliders");
  cli::AddSceneOptions(*command, options->scene, options->scene_format, "Scene with named materials",
                       /*required=*/true);
  cli::AddSonar(*command, options->sonar, " (default: that of --real)");
  command->add_option("--params", options->params, "Start parameters (default: those of the built-in scenes)")
      ->type_name("JSON");
  command
      ->add_option("--poses", options->poses,
                   "Poses, one per frame: a recording with poses, or a JSON file (default: those of --real, "
                   "else one in front of the scene)")
      ->type_name("REC|FILE");
  command->add_option("--real", options->real, "Recording to show beside the simulation, and to fit to")
      ->type_name("REC");
  cli::AddOutFolder(*command, options->out, options->common,
                    "Folder that the page writes parameters and poses into (default: none, only downloads)");
  cli::AddOptions(*command, *options);
  command->add_option("--port", options->port, "Port of 127.0.0.1 to listen on, 0 for any that is free")
      ->type_name("N")
      ->check(CLI::Range(0, 65535).description(""));
  command->add_flag("--open,!--no-browser", options->open,
                    "Open the page in the desktop's browser (default: no)");
  cli::OnRun(command, options->common, [command, options] {
    cli::RefuseUnusedSegmentation(*command, options->comparison);
    return RunView(*options);
  });
}

}  // namespace sonarcal::commands
