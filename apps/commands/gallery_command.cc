// `sonarcal gallery`: simulated images of each scene, as in Park 2024 Figs. 6 to 8: one row per viewpoint,
// with depth image, fan image and polar image.
//
// Writes gallery.html; <scene>_<viewpoint>_depth.png, _fan.png and _polar.png; <scene>.png with all rows of a
// scene; params.json as used.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/command.h"
#include "apps/cli/given_options.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/cli/scene_option.h"
#include "apps/cli/sonar_option.h"
#include "apps/commands/commands.h"
#include "apps/commands/scenes_command.h"
#include "apps/report/html/html_report.h"
#include "apps/report/html/report_end.h"
#include "apps/report/pictures/gallery_pictures.h"
#include "apps/workflow/rays/ray_options.h"
#include "apps/workflow/simulate.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/images/image_io.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "sim/scenes/environments.h"

namespace sonarcal::commands {
namespace {

struct GalleryOptions {
  cli::CommonOptions common;
  std::filesystem::path out;
  std::vector<std::string> only;  // names of sim/scenes/environments.h; empty: all
  sim::EnvironmentOptions environment = {.bed = true};
  bool no_bed = false;          // leaves out the bed of mock-up, bridge pier and jacket
  std::filesystem::path scene;  // scene of the user, in place of the built-in ones
  cli::SceneFormat scene_format;
  std::filesystem::path poses;   // for the scene of the user
  std::filesystem::path params;  // empty: EnvironmentParameters
  std::string sonar = "p900-45";
  int views = 0;  // number of viewpoints of each scene; 0: all
  workflow::RayOptions rays{sim::Sampling::kFrustum};
};

using Json = nlohmann::ordered_json;

struct Exhibit {
  std::string name;  // for file names
  std::string title;
  std::string description;
  Scene scene;
  std::vector<Pose> poses;
};

// Makes one exhibit at a time, because a scene may be large.
std::vector<std::function<Exhibit()>> Exhibits(const GalleryOptions& options) {
  if (!options.scene.empty()) {
    if (options.poses.empty()) throw UsageError("--poses is required with --scene");
    if (!options.only.empty())
      throw UsageError("--only is for the scenes of `sonarcal scenes`, not for --scene");
    return {[&options] {
      Exhibit exhibit{"scene",
                      options.scene.filename().string(),
                      "A scene from a file.",
                      cli::ReadSceneFile(options.scene, options.scene_format, options.common),
                      {}};
      for (const data_io::TimedPose& pose : data_io::ReadPosesOrRecording(options.poses)) {
        exhibit.poses.push_back(pose.world_from_sonar);
      }
      return exhibit;
    }};
  }
  if (!options.poses.empty()) throw UsageError("--poses is for a scene of your own: --scene");
  sim::EnvironmentOptions environment_options = options.environment;
  environment_options.bed = !options.no_bed;
  std::vector<std::function<Exhibit()>> exhibits;
  for (const sim::Environment* environment : ChosenEnvironments(options.only)) {
    exhibits.emplace_back([environment, environment_options] {
      std::string description = fmt::format("{}.", environment->description);
      if (environment->bed_m > 0.0 && environment_options.bed) {
        description +=
            fmt::format(" On a flat bed of {:g} x {:g} m.", environment->bed_m, environment->bed_m);
      }
      return Exhibit{std::string(environment->name), std::string(environment->title), std::move(description),
                     environment->make(environment_options), environment->viewpoints()};
    });
  }
  return exhibits;
}

std::string PlaceText(const Pose& pose) {
  const Eigen::Vector3d ahead = pose.rotation * Eigen::Vector3d::UnitY();
  const double up = std::clamp(ahead.z(), -1.0, 1.0);  // rounding may exceed 1
  return fmt::format("sonar at ({:.1f}, {:.1f}, {:.1f}) m, looking {:.0f} degrees {}", pose.position_m.x(),
                     pose.position_m.y(), pose.position_m.z(), std::abs(std::asin(up)) / kRadPerDeg,
                     up > 0.0 ? "up" : "down");
}

// Writes the pictures of one exhibit and adds it to the report.
void Show(const Exhibit& exhibit, const sim::Simulator& simulator, const ParameterSet& parameters,
          int views_wanted, const cli::RunOutput& output, std::vector<std::string>& files,
          report::HtmlReport& report) {
  const std::size_t count =
      views_wanted == 0 ? exhibit.poses.size() : std::min<std::size_t>(views_wanted, exhibit.poses.size());
  std::vector<report::GalleryView> views;
  for (std::size_t i = 0; i < count; ++i) {
    views.push_back(report::SeeView(simulator, exhibit.poses[i], parameters, static_cast<int>(i)));
  }
  const double brightest = report::BrightestGrey(views);
  report.Section(exhibit.title);
  report.Paragraph(exhibit.description);
  report.Paragraph(
      fmt::format("Brightest colour of fan and polar images: grey level {:.0f} of {:.0f}; colours "
                  "follow the square root of the level.",
                  brightest, simulator.options().full_scale()));
  std::vector<report::GalleryPictures> sheet;
  for (std::size_t i = 0; i < count; ++i) {
    sheet.push_back(report::MakePictures(views[i], brightest));
    const auto written = [&](const char* what, const RgbImage& picture, std::string caption, std::string alt,
                             std::optional<report::SonarView> view = {}) {
      files.push_back(fmt::format("{}_{}_{}.png", exhibit.name, i + 1, what));
      data_io::WritePng(output / files.back(), picture);
      report::Picture shown{
          .png = data_io::EncodePng(picture), .caption = std::move(caption), .alt = std::move(alt)};
      if (view) {
        shown.plot = report::SonarPlot{.axes = views[i].image.axes,
                                       .view = *view,
                                       .colours = report::SonarColours::kInferno,
                                       .bar = {"0", "grey level, root", fmt::format("{:.0f}", brightest)}};
      }
      return shown;
    };
    const std::string of = fmt::format("of {}, viewpoint {} (simulated)", exhibit.title, i + 1);
    report.Add(report::PictureRow{
        .caption = fmt::format("{}, viewpoint {}: {}. Simulated.", exhibit.title, i + 1,
                               PlaceText(exhibit.poses[i])),
        .pictures = {
            written("depth", sheet.back().depth, "Depth", "Depth image " + of),
            written("fan", sheet.back().fan, "Fan", "Fan image " + of, report::SonarView::kFan),
            written("polar", sheet.back().polar, "Polar", "Polar image " + of, report::SonarView::kPolar)}});
  }
  files.push_back(exhibit.name + ".png");
  data_io::WritePng(output / files.back(), report::Sheet(sheet));
}

}  // namespace

cli::ExitStatus RunGallery(const GalleryOptions& options) {
  const workflow::ThreadLimit threads(options.rays.threads);
  const auto exhibits = Exhibits(options);
  const ParameterSet parameters =
      options.params.empty() ? EnvironmentParameters() : data_io::ReadParameters(options.params);
  workflow::CheckRayWeight(options.rays.ray_weight, parameters.model);
  const workflow::SonarChoice choice = workflow::ChooseSonar(options.sonar);
  const workflow::WaterChoice water = workflow::ChooseWater(parameters, choice.water);
  if (!water.note.empty()) cli::PrintNote(options.common, water.note);
  const sim::SimulationOptions simulation = options.rays.For(choice.sonar, water.water, parameters);

  report::HtmlReport report(
      "Gallery", fmt::format("{}, {} model, noise-free", choice.sonar.name, ToString(parameters.model)));
  report.Callout(report::CalloutKind::kSynthetic, "Everything on this page is simulated",
                 "No recording is shown, and no scene is a survey of a real place.");
  report.Paragraph(
      "A row is one place of the sonar. Depth: range along the rays of a pinhole camera with the sonar's "
      "field of view, near is bright, white is nothing within range. Fan: ahead is up, to scale. Polar: "
      "azimuth from left to right, range from top (nearest) to bottom.");

  cli::RunOutput output(options.out, "gallery", options.common.force);
  std::vector<std::string> files;
  Json names = Json::array();
  {
    cli::Progress progress("Simulating", static_cast<int>(exhibits.size()), options.common);
    for (const auto& make : exhibits) {
      Exhibit exhibit = make();
      const sim::Simulator simulator(std::exchange(exhibit.scene, {}), choice.sonar, simulation);
      Show(exhibit, simulator, parameters, options.views, output, files, report);
      names.push_back(exhibit.name);
      progress.Advance();
    }
  }
  cli::Provenance provenance{.command = "gallery",
                             .configuration = {{"out", options.out.string()},
                                               {"scenes", names},
                                               {"edge_m", options.environment.max_edge_m},
                                               {"surface", options.environment.surface},
                                               {"bed", !options.no_bed},
                                               {"views", options.views},
                                               {"sonar", options.sonar}},
                             .seed = options.environment.seed};
  const RayGridSize grid{simulation.fan.cols, simulation.fan.rows};
  workflow::RayOptions cast = options.rays;
  cast.rays = grid;
  provenance.configuration.update(cli::OptionsJson(cast));
  provenance.configuration.update(cli::SceneFormatJson(options.scene_format));
  for (const auto& input : {options.scene, options.poses, options.params}) {
    if (!input.empty()) provenance.inputs.push_back(input);
  }
  if (choice.input) provenance.inputs.push_back(*choice.input);
  data_io::WriteParameters(output / "params.json", parameters);
  cli::WriteProvenance(output.staging(), provenance);
  report::EndReport(report, cli::ProvenanceToJson(provenance));
  report.Write(output / "gallery.html");
  output.Commit();

  if (options.common.json) {
    cli::PrintJson({{"report", (output.final_path() / "gallery.html").string()}, {"files", files}});
  } else {
    cli::PrintResult(fmt::format("{}: {} pictures of {} {}\n", (options.out / "gallery.html").string(),
                                 files.size(), exhibits.size(), exhibits.size() == 1 ? "scene" : "scenes"));
  }
  return cli::ExitStatus::kDone;
}

void SetupGallery(CLI::App& app) {
  auto options = std::make_shared<GalleryOptions>();
  CLI::App* command =
      cli::AddCommand(app, "gallery", "Shows scenes as a sonar sees them, from several viewpoints");
  cli::AddOutFolder(*command, options->out, options->common, "Folder for the page and its pictures")
      ->required();
  AddEnvironmentOptions(*command, options->only, options->environment);
  command->add_flag("--no-bed", options->no_bed,
                    "Leave mock-up, bridge pier and jacket without the flat bed they stand on");
  cli::AddSceneOptions(*command, options->scene, options->scene_format,
                       "A scene of your own, in place of the program's", /*required=*/false);
  command->add_option("--poses", options->poses, "Its viewpoints: a recording with poses, or a JSON file")
      ->type_name("REC|FILE");
  command
      ->add_option("--params", options->params,
                   "Parameters (default: the paper's Table 4 for every material of the program's scenes)")
      ->type_name("JSON");
  cli::AddSonar(*command, options->sonar);
  command->add_option("--views", options->views, "Number of viewpoints of each scene, 0 for all")
      ->type_name("N")
      ->check(CLI::Range(0, 10000).description(""));
  cli::AddOptions(*command, options->rays);
  cli::OnRun(command, options->common, [command, options] {
    cli::RefuseSceneFormatAlone(*command);
    if (!options->scene.empty())
      cli::RefuseGiven(*command, {"--edge", "--seed", "--surface", "--no-bed"}, "with --scene");
    return RunGallery(*options);
  });
}

}  // namespace sonarcal::commands
