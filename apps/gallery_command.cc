#include "apps/gallery_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/gallery_pictures.h"
#include "apps/given_options.h"
#include "apps/progress.h"
#include "apps/provenance.h"
#include "apps/report/html_report.h"
#include "apps/report/report_end.h"
#include "apps/run_output.h"
#include "apps/scenes_command.h"
#include "apps/simulate_recording.h"
#include "apps/sonar_option.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/images/image_io.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

struct Exhibit {
  std::string name;  // of files
  std::string title;
  std::string description;
  Scene scene;
  std::vector<Pose> poses;
};

// Made one at a time, as a scene may be large.
std::vector<std::function<Exhibit()>> Exhibits(const GalleryOptions& options) {
  if (!options.scene.empty()) {
    if (options.poses.empty()) throw UsageError("--poses is required with --scene");
    if (!options.only.empty())
      throw UsageError("--only is for the scenes of `sonarcal scenes`, not for --scene");
    return {[&options] {
      Exhibit exhibit{"scene",
                      options.scene.filename().string(),
                      "A scene from a file.",
                      ReadSceneFile(options.scene, options.scene_format, options.common),
                      {}};
      for (const TimedPose& pose : ReadPosesOrRecording(options.poses)) {
        exhibit.poses.push_back(pose.world_from_sonar);
      }
      return exhibit;
    }};
  }
  if (!options.poses.empty()) throw UsageError("--poses is for a scene of your own: --scene");
  EnvironmentOptions environment_options = options.environment;
  environment_options.bed = !options.no_bed;
  std::vector<std::function<Exhibit()>> exhibits;
  for (const Environment* environment : ChosenEnvironments(options.only)) {
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
  return fmt::format("sonar at ({:.1f}, {:.1f}, {:.1f}) m, looking {:.0f} degrees {}", pose.position_m.x(),
                     pose.position_m.y(), pose.position_m.z(), std::abs(std::asin(ahead.z())) / kRadPerDeg,
                     ahead.z() > 0.0 ? "up" : "down");
}

// Writes the pictures of one exhibit, and adds it to the report.
void Show(const Exhibit& exhibit, const Simulator& simulator, const ParameterSet& parameters,
          int views_wanted, const RunOutput& output, std::vector<std::string>& files, HtmlReport& report) {
  const std::size_t count =
      views_wanted == 0 ? exhibit.poses.size() : std::min<std::size_t>(views_wanted, exhibit.poses.size());
  std::vector<GalleryView> views;
  for (std::size_t i = 0; i < count; ++i) {
    views.push_back(SeeView(simulator, exhibit.poses[i], parameters, static_cast<int>(i)));
  }
  const double brightest = BrightestGrey(views);
  report.Section(exhibit.title);
  report.Paragraph(exhibit.description);
  report.Paragraph(
      fmt::format("Brightest colour of fan and polar images: grey level {:.0f} of {:.0f}; colours "
                  "follow the square root of the level.",
                  brightest, simulator.options().full_scale()));
  std::vector<GalleryPictures> sheet;
  for (std::size_t i = 0; i < count; ++i) {
    sheet.push_back(MakePictures(views[i], brightest));
    const auto written = [&](const char* what, const RgbImage& picture, std::string caption,
                             std::string alt) {
      files.push_back(fmt::format("{}_{}_{}.png", exhibit.name, i + 1, what));
      WritePng(output / files.back(), picture);
      return Picture{.png = EncodePng(picture), .caption = std::move(caption), .alt = std::move(alt)};
    };
    const std::string of = fmt::format("of {}, viewpoint {} (simulated)", exhibit.title, i + 1);
    report.Add(PictureRow{.caption = fmt::format("{}, viewpoint {}: {}. Simulated.", exhibit.title, i + 1,
                                                 PlaceText(exhibit.poses[i])),
                          .pictures = {written("depth", sheet.back().depth, "Depth", "Depth image " + of),
                                       written("fan", sheet.back().fan, "Fan", "Fan image " + of),
                                       written("polar", sheet.back().polar, "Polar", "Polar image " + of)}});
  }
  files.push_back(exhibit.name + ".png");
  WritePng(output / files.back(), Sheet(sheet));
}

}  // namespace

ExitStatus RunGallery(const GalleryOptions& options) {
  const ThreadLimit threads(options.rays.threads);
  const auto exhibits = Exhibits(options);
  const ParameterSet parameters =
      options.params.empty() ? EnvironmentParameters() : ReadParameters(options.params);
  CheckRayWeight(options.rays.weight, parameters.model);
  const SonarChoice choice = ChooseSonar(options.sonar);
  const WaterChoice water = ChooseWater(parameters, choice.water);
  if (!water.note.empty()) PrintNote(options.common, water.note);
  const SimulationOptions simulation = options.rays.For(choice.sonar, water.water, parameters);

  HtmlReport report("Gallery",
                    fmt::format("{}, {} model, noise-free", choice.sonar.name, ToString(parameters.model)));
  report.Callout(CalloutKind::kSynthetic, "Everything on this page is simulated",
                 "No recording is shown, and no scene is a survey of a real place.");
  report.Paragraph(
      "A row is one place of the sonar. Depth: range along the rays of a pinhole camera with the sonar's "
      "field "
      "of view, near is bright, white is nothing within range. Fan: ahead is up, to scale. Polar: azimuth "
      "from "
      "left to right, range from top (nearest) to bottom.");

  RunOutput output(options.out, "gallery", options.common.force);
  std::vector<std::string> files;
  Json names = Json::array();
  {
    Progress progress("Simulating", static_cast<int>(exhibits.size()), options.common);
    for (const auto& make : exhibits) {
      Exhibit exhibit = make();
      const Simulator simulator(std::exchange(exhibit.scene, {}), choice.sonar, simulation);
      Show(exhibit, simulator, parameters, options.views, output, files, report);
      names.push_back(exhibit.name);
      progress.Advance();
    }
  }
  Provenance provenance{.command = "gallery",
                        .configuration = {{"out", options.out.string()},
                                          {"scenes", names},
                                          {"edge_m", options.environment.max_edge_m},
                                          {"surface", options.environment.surface},
                                          {"bed", !options.no_bed},
                                          {"views", options.views},
                                          {"sonar", options.sonar}},
                        .seed = options.environment.seed};
  const RayGridSize grid{simulation.fan.cols, simulation.fan.rows};
  provenance.configuration.update(RayOptionsJson(options.rays, grid));
  provenance.configuration.update(SceneFormatJson(options.scene_format));
  for (const auto& input : {options.scene, options.poses, options.params}) {
    if (!input.empty()) provenance.inputs.push_back(input);
  }
  if (choice.input) provenance.inputs.push_back(*choice.input);
  WriteParameters(output / "params.json", parameters);
  WriteProvenance(output.staging(), provenance);
  EndReport(report, ProvenanceToJson(provenance));
  report.Write(output / "gallery.html");
  output.Commit();

  if (options.common.json) {
    PrintJson({{"report", (output.final_path() / "gallery.html").string()}, {"files", files}});
  } else {
    PrintResult(fmt::format("{}: {} pictures of {} {}\n", (options.out / "gallery.html").string(),
                            files.size(), exhibits.size(), exhibits.size() == 1 ? "scene" : "scenes"));
  }
  return ExitStatus::kDone;
}

void SetupGallery(CLI::App& app) {
  auto options = std::make_shared<GalleryOptions>();
  CLI::App* command = AddCommand(
      app, "gallery", "Shows each scene as a sonar sees it: depth, fan and polar image, several viewpoints");
  AddOutFolder(*command, options->out, options->common, "Folder for the page and its pictures")->required();
  AddEnvironmentOptions(*command, options->only, options->environment);
  command->add_flag("--no-bed", options->no_bed,
                    "Leave mock-up, bridge pier and jacket without the flat bed they stand on");
  AddSceneOptions(*command, options->scene, options->scene_format,
                  "A scene of your own, in place of the program's", /*required=*/false);
  command->add_option("--poses", options->poses, "Its viewpoints: a recording that has poses, or a JSON file")
      ->type_name("REC|FILE");
  command
      ->add_option("--params", options->params,
                   "Parameters (default: the paper's Table 4 for every material of the program's scenes)")
      ->type_name("JSON");
  AddSonar(*command, options->sonar);
  command->add_option("--views", options->views, "The first so many viewpoints of each scene, 0 for all")
      ->type_name("N")
      ->check(CLI::Range(0, 10000).description(""));
  AddRayOptions(*command, options->rays);
  OnRun(command, options->common, [command, options] {
    RefuseSceneFormatAlone(*command);
    if (!options->scene.empty())
      RefuseGiven(*command, {"--edge", "--seed", "--surface", "--no-bed"}, "with --scene");
    return RunGallery(*options);
  });
}

}  // namespace sonarcal
