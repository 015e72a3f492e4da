// `sonarcal rays`: errors of images with several ray counts, relative to an image of very many rays, for both
// samplings (apps/workflow/rays/ray_errors.h). Output as a table, JSON, and a report with a chart.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/choice_option.h"
#include "apps/cli/command.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/cli/scene_option.h"
#include "apps/cli/sonar_option.h"
#include "apps/commands/commands.h"
#include "apps/report/html/html_report.h"
#include "apps/report/html/report_end.h"
#include "apps/workflow/rays/ray_errors.h"
#include "apps/workflow/simulate.h"
#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/json/json_writer.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"

namespace sonarcal::commands {
namespace {

struct RaysOptions {
  cli::CommonOptions common;
  std::filesystem::path scene;
  cli::SceneFormat scene_format;
  std::string sonar;
  std::filesystem::path params;
  std::filesystem::path poses;
  std::filesystem::path out;              // empty: only the table
  std::vector<std::string> counts;        // "WxH"; empty: DefaultGrids
  std::optional<sim::Sampling> sampling;  // absent: both
  std::string dense = "1500x1200";        // has `denser` times these rays
  double denser = 64.0;
  workflow::RayOptions rays;         // weight, absorption and threads
  std::optional<double> display_db;  // span up to the brightest echo; absent: the display of the parameters
};

RayGridSize ParseGrid(const std::string& text) {
  RayGridSize grid;
  if (OptionText<RayGridSize>::Parse(text, grid)) return grid;
  throw UsageError("rays '{}', expected {}", Printable(text), OptionText<RayGridSize>::kExpected);
}

using Json = nlohmann::ordered_json;

struct Measured {
  std::string sonar;
  std::size_t poses = 0;
  std::string display;  // such as "150 .. 153 dB over 255 grey levels"
  workflow::RayErrors errors;
};

std::string GridText(const RayGridSize& grid) {
  return fmt::format("{}x{}", grid.cols, grid.rows);
}

Json JsonOf(const workflow::ImageError& e) {
  return {{"error_grey", {{"p99.9", e.p999_grey}, {"max", e.max_grey}}},
          {"error_db", {{"p99.9", e.p999_db}}},
          {"within_one_grey", {{"pixels", e.within_one}, {"lit_pixels", e.within_one_lit}}}};
}

Json JsonOf(const workflow::RayError& e) {
  Json json = {{"sampling", ToString(e.sampling)},
               {"rays", GridText(e.grid)},
               {"count", e.rays()},
               {"denser", e.denser}};
  json.update(JsonOf(static_cast<const workflow::ImageError&>(e)));
  return json;
}

Json JsonOf(const RaysOptions& options, const Measured& measured) {
  Json counts = Json::array();
  for (const workflow::RayError& error : measured.errors.counts) counts.push_back(JsonOf(error));
  Json fewest = Json::object();
  for (const auto& [word, sampling] : WordsOf(std::type_identity<sim::Sampling>{})) {
    if (options.sampling && *options.sampling != sampling) continue;
    const auto found = workflow::MinRays(measured.errors.counts, sampling);
    fewest[std::string(word)] = found ? Json(GridText(found->grid)) : Json(nullptr);
  }
  Json json = {{"scene", options.scene.string()},
               {"sonar", measured.sonar},
               {"poses", measured.poses},
               {"display", measured.display},
               {"ray_weight", ToString(options.rays.weight())},
               {"synthetic", true},
               {"counts", counts},
               {"fewest_within_one_grey", fewest}};
  if (measured.errors.between) json["between_samplings"] = JsonOf(*measured.errors.between);
  return json;
}

std::string_view WeightText(sim::RayWeight weight) {
  return weight == sim::RayWeight::kEven ? "evenly" : "by solid angle";
}

std::string MinRaysText(const std::vector<workflow::RayError>& errors, sim::Sampling sampling) {
  const auto fewest = workflow::MinRays(errors, sampling);
  if (!fewest) {
    return fmt::format("{}: none of these leaves 99.9 % of the pixels within one grey level",
                       ToString(sampling));
  }
  return fmt::format("{}: {} is the fewest of these within one grey level in 99.9 % of the pixels",
                     ToString(sampling), GridText(fewest->grid));
}

std::vector<std::string> MinRaysTexts(const RaysOptions& options, const Measured& measured) {
  std::vector<std::string> texts;
  for (const auto& [word, sampling] : WordsOf(std::type_identity<sim::Sampling>{})) {
    if (!options.sampling || *options.sampling == sampling)
      texts.push_back(MinRaysText(measured.errors.counts, sampling));
  }
  if (measured.errors.between) {
    const workflow::ImageError& e = *measured.errors.between;
    texts.push_back(
        fmt::format("between the dense images of both: {:.2f} grey levels in 99.9 % of the pixels, {:.2f} at "
                    "most, {:.3f} % within one",
                    e.p999_grey, e.max_grey, 100.0 * e.within_one));
  }
  return texts;
}

std::string TableText(const RaysOptions& options, const Measured& measured) {
  std::string text = fmt::format("{}: error against rays over {} pose{}, {}, rays weighed {}\n",
                                 options.scene.string(), measured.poses, measured.poses == 1 ? "" : "s",
                                 measured.display, WeightText(options.rays.weight()));
  text += fmt::format("  {:<8} {:>11} {:>9} {:>7} {:>11} {:>9} {:>9} {:>9} {:>9}\n", "sampling", "rays",
                      "count", "denser", "99.9 % grey", "99.9 % dB", "max grey", "within 1", "of lit");
  for (const workflow::RayError& e : measured.errors.counts) {
    text += fmt::format("  {:<8} {:>11} {:>9} {:>7.1f} {:>11.2f} {:>9.4f} {:>9.2f} {:>8.3f}% {:>8.2f}%\n",
                        ToString(e.sampling), GridText(e.grid), e.rays(), e.denser, e.p999_grey, e.p999_db,
                        e.max_grey, 100.0 * e.within_one, 100.0 * e.within_one_lit);
  }
  for (const std::string& line : MinRaysTexts(options, measured)) text += "  " + line + "\n";
  return text;
}

report::LineChart ErrorChart(const RaysOptions& options, const Measured& measured) {
  report::LineChart chart{.title = "Error against rays",
                          .x = {.label = "log10 of the number of rays"},
                          .y = {.label = "log10 of the 99.9th percentile", .unit = "grey levels"},
                          .alt = "The error falls as rays are added"};
  for (const auto& [word, sampling] : WordsOf(std::type_identity<sim::Sampling>{})) {
    if (options.sampling && *options.sampling != sampling) continue;
    report::ChartSeries series{
        .name = std::string(word), .x = {}, .y = {}, .style = report::SeriesStyle::kPoints};
    for (const workflow::RayError& e : measured.errors.counts) {
      if (e.sampling != sampling || !(e.p999_grey > 0.0)) continue;
      series.x.push_back(std::log10(static_cast<double>(e.rays())));
      series.y.push_back(std::log10(e.p999_grey));
    }
    chart.series.push_back(series);
  }
  return chart;
}

report::HtmlReport MakeReport(const RaysOptions& options, const Measured& measured, const Json& provenance) {
  report::HtmlReport report("Error against rays",
                            fmt::format("{} seen by {}", options.scene.string(), measured.sonar));
  report.Callout(
      report::CalloutKind::kSynthetic, "Simulated on both sides",
      "Images of few rays against images of many, by the paper's model: nothing here was recorded.");
  report.Section("Errors");
  report.List(MinRaysTexts(options, measured));
  report::Table table{.caption = fmt::format("Errors over all pixels of {} pose{}; {}; rays weighed {}",
                                             measured.poses, measured.poses == 1 ? "" : "s", measured.display,
                                             WeightText(options.rays.weight())),
                      .columns = {{"Sampling and rays"},
                                  {"Rays"},
                                  {"Dense image", "times the rays"},
                                  {"99.9th percentile", "grey levels"},
                                  {"99.9th percentile", "dB"},
                                  {"Largest", "grey levels"},
                                  {"Within one level", "% of pixels"},
                                  {"Within one level", "% of lit pixels"}},
                      .rows = {}};
  for (const workflow::RayError& e : measured.errors.counts) {
    const auto fewest = workflow::MinRays(measured.errors.counts, e.sampling);
    table.rows.push_back(
        {{fmt::format("{} {}", ToString(e.sampling), GridText(e.grid)), fmt::format("{}", e.rays()),
          fmt::format("{:.1f}", e.denser), fmt::format("{:.2f}", e.p999_grey),
          fmt::format("{:.4f}", e.p999_db), fmt::format("{:.2f}", e.max_grey),
          fmt::format("{:.3f}", 100.0 * e.within_one), fmt::format("{:.2f}", 100.0 * e.within_one_lit)},
         fewest && fewest->rays() == e.rays() ? report::RowStyle::kStrong : report::RowStyle::kPlain});
  }
  table.notes = {
      "Each sampling is compared with its own dense image; images are not rounded before they are compared.",
      "dB: of the level displayed, grey levels times the display's span over its full scale.",
      "Lit: half a grey level or more in either image."};
  report.Add(table);
  report.Add({ErrorChart(options, measured)},
             "99.9th percentile of the error against rays, both in logarithms");
  report::EndReport(report, provenance);
  return report;
}

cli::Provenance ProvenanceOf(const RaysOptions& options, const workflow::SonarChoice& choice) {
  Json counts = Json::array();
  for (const std::string& count : options.counts) counts.push_back(count);
  cli::Provenance provenance{
      .command = "rays",
      .configuration = {{"scene", options.scene.string()},
                        {"sonar", options.sonar},
                        {"params", options.params.string()},
                        {"poses", options.poses.string()},
                        {"out", options.out.string()},
                        {"counts", counts},
                        {"sampling", options.sampling ? Json(ToString(*options.sampling)) : Json(nullptr)},
                        {"dense", options.dense},
                        {"denser", options.denser},
                        {"ray_weight", ToString(options.rays.weight())},
                        {"display_db", options.display_db ? Json(*options.display_db) : Json(nullptr)},
                        {"absorption", ToString(options.rays.absorption)},
                        {"threads", options.rays.threads}},
      .inputs = {options.scene, options.params, options.poses}};
  provenance.configuration.update(cli::SceneFormatJson(options.scene_format));
  if (choice.input && *choice.input != options.poses) provenance.inputs.push_back(*choice.input);
  return provenance;
}

}  // namespace

cli::ExitStatus RunRays(const RaysOptions& options) {
  const workflow::ThreadLimit threads(options.rays.threads);
  workflow::RayErrorOptions errors{
      .dense = ParseGrid(options.dense), .denser = options.denser, .weight = options.rays.weight()};
  for (const std::string& count : options.counts) errors.grids.push_back(ParseGrid(count));
  if (options.sampling) errors.samplings = {*options.sampling};
  ParameterSet parameters = data_io::ReadParameters(options.params);
  const workflow::SonarChoice choice = workflow::ChooseSonar(options.sonar);
  const workflow::WaterChoice water = workflow::ChooseWater(parameters, choice.water);
  if (!water.note.empty()) cli::PrintNote(options.common, water.note);
  sim::SimulationOptions simulation;
  simulation.absorption = options.rays.absorption;
  simulation.water = water.water;
  std::vector<Pose> poses;
  for (const data_io::TimedPose& pose : data_io::ReadPosesOrRecording(options.poses))
    poses.push_back(pose.world_from_sonar);
  const sim::RayCaster caster(cli::ReadSceneFile(options.scene, options.scene_format, options.common));
  std::optional<cli::RunOutput> output;
  if (!options.out.empty()) output.emplace(options.out, "rays", options.common.force);

  if (options.display_db) {
    parameters.display = workflow::DisplayUpToBrightest(caster, choice.sonar, parameters, simulation, poses,
                                                        errors.dense, *options.display_db);
  }
  Measured measured{
      .sonar = choice.sonar.name,
      .poses = poses.size(),
      .display = fmt::format("{:.5g} .. {:.5g} dB over {:g} grey levels", parameters.display.db_min,
                             parameters.display.db_max, simulation.full_scale()),
      .errors = {}};
  {
    cli::Progress progress("Rendering", workflow::RayErrorImages(choice.sonar, poses.size(), errors),
                           options.common);
    measured.errors = workflow::MeasureRayErrors(caster, choice.sonar, parameters, simulation, poses, errors,
                                                 [&] { progress.Advance(); });
  }
  const Json json = JsonOf(options, measured);
  if (output) {
    const cli::Provenance provenance = ProvenanceOf(options, choice);
    data_io::WriteJson(*output / "rays.json", json);
    MakeReport(options, measured, cli::ProvenanceToJson(provenance)).Write(*output / "report.html");
    cli::WriteProvenance(output->staging(), provenance);
    output->Commit();
  }
  if (options.common.json) {
    cli::PrintJson(json);
  } else {
    cli::PrintResult(TableText(options, measured));
    if (output) cli::PrintResult(fmt::format("report: {}\n", (options.out / "report.html").string()));
  }
  return cli::ExitStatus::kDone;
}

void SetupRays(CLI::App& app) {
  auto options = std::make_shared<RaysOptions>();
  CLI::App* command = cli::AddCommand(app, "rays", "Measures the error of images with few rays");
  cli::AddSceneOptions(*command, options->scene, options->scene_format, "Scene with named materials",
                       /*required=*/true);
  cli::AddSonar(*command, options->sonar)->required();
  command->add_option("--params", options->params, "Parameters of the paper's model")
      ->type_name("JSON")
      ->required();
  command->add_option("--poses", options->poses, "Poses: a recording with poses, or a JSON file")
      ->type_name("REC|FILE")
      ->required();
  cli::AddOutFolder(*command, options->out, options->common,
                    "Folder for rays.json and report.html (default: none is written)");
  cli::AddChoice(*command, "--sampling", options->sampling, "Arrangement of the rays (default: both)");
  command
      ->add_option("--rays", options->counts,
                   "Columns x rows of rays to try, may be repeated (default: a series)")
      ->type_name("WxH");
  command->add_option("--dense", options->dense, "Rays of the dense image, before --denser")
      ->type_name("WxH");
  command
      ->add_option("--denser", options->denser, "Number of rays of the dense image, as a multiple of --dense")
      ->type_name("N")
      ->check(cli::Within(1.0, 1024.0));
  cli::AddOptionNamed(*command, options->rays, "ray_weight");
  command
      ->add_option(
          "--display-db", options->display_db,
          "Span of the display up to the brightest echo at these poses (default: the parameters' display)")
      ->type_name("DB")
      ->check(cli::Within(0.1, 1000.0));
  cli::AddOptionNamed(*command, options->rays, "threads");
  cli::OnRun(command, options->common, [options] { return RunRays(*options); });
}

}  // namespace sonarcal::commands
