// `sonarcal judge-noise`: judges a noise law that `fit --noise-only` wrote on other pings, without a fit
// (calib/noise/noise_judgement.h). Prints the figures, and with --out writes judgement.json and a report.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/choice_option.h"
#include "apps/cli/command.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/commands/commands.h"
#include "apps/report/html/paper_files.h"
#include "apps/report/html/report_end.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/report/sections/noise_section.h"
#include "apps/workflow/compare.h"
#include "calib/noise/noise_judgement.h"
#include "core/types/error.h"
#include "data_io/json/json_reader.h"
#include "data_io/json/json_writer.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::commands {
namespace {

using Json = nlohmann::ordered_json;

struct JudgeNoiseOptions {
  cli::CommonOptions common;
  std::filesystem::path params;
  std::filesystem::path real;
  std::filesystem::path out;  // empty: only the figures are printed
  FrameList frames;           // empty: all
  std::optional<double> range_min_m;
  std::optional<double> range_max_m;
  std::optional<sim::SpeckleLaw> speckle;
};

// Statements of the fit of a law, beside its parameters.
struct FittedPart {
  std::filesystem::path file;  // empty: there is none
  sim::SpeckleLaw speckle = sim::SpeckleLaw::kGamma;
  calib::NoiseWindow window;
  std::vector<std::pair<int, int>> left_out;  // band, beam
};

// Reads fit.json beside the parameters, if it is that of a noise law.
FittedPart ReadFittedPart(const std::filesystem::path& params) {
  FittedPart part;
  const std::filesystem::path file = params.parent_path() / "fit.json";
  if (!std::filesystem::exists(file)) return part;
  const data_io::JsonReader json = data_io::JsonReader::FromFile(file);
  const auto speckle = json.Find("speckle");
  const auto window = json.Find("window");
  if (!speckle || !window) return part;
  part.file = file;
  part.speckle = speckle->Word<sim::SpeckleLaw>();
  const std::vector<double> range_m = window->At("range_m").Numbers();
  if (range_m.size() != 2) window->At("range_m").Fail("is not two numbers");
  part.window.range_min_m = range_m[0];
  part.window.range_max_m = range_m[1];
  if (const auto bins = window->Find("band_bins"))
    part.window.band_bins = static_cast<int>(bins->Integer(1, 4096));
  if (const auto cells = window->Find("cells_left_out")) {
    for (const data_io::JsonReader& cell : cells->Items()) {
      const std::vector<double> place = cell.Numbers(data_io::NumberRange::Between(0, 1e6));
      if (place.size() != 2) cell.Fail("is not a band and a beam");
      part.left_out.emplace_back(static_cast<int>(place[0]), static_cast<int>(place[1]));
    }
  }
  return part;
}

std::vector<double> WeightOf(const FittedPart& part, const calib::NoiseCells& cells,
                             const RecordingInfo& info) {
  std::vector<double> weight(cells.count(), 1.0);
  for (const auto& [band, beam] : part.left_out) {
    if (band >= cells.bands() || beam >= cells.beams()) {
      throw DataError(
          "{}: {} leaves out the cell of band {} and beam {}, but there are {} bands and {} beams, expected "
          "pings of the same geometry, or a --range-min and --range-max to judge without these cells",
          info.source, part.file.string(), band, beam, cells.bands(), cells.beams());
    }
    weight[static_cast<std::size_t>(band) * cells.beams() + beam] = 0.0;
  }
  return weight;
}

Json ConfigurationJson(const JudgeNoiseOptions& options, const calib::NoiseJudgement& judgement,
                       sim::SpeckleLaw speckle) {
  const PolarAxes& axes = judgement.cells.axes;
  return {{"params", options.params.string()},
          {"real", options.real.string()},
          {"out", options.out.string()},
          {"frames", judgement.frames},
          {"range_m",
           {axes.range_edge_m(judgement.cells.first_bin), axes.range_edge_m(judgement.cells.last_bin)}},
          {"speckle", ToString(speckle)}};
}

report::HtmlReport MakeReport(const calib::NoiseJudgement& judgement, const RecordingInfo& info,
                              const std::string& subject, const Json& provenance) {
  report::HtmlReport report("Noise law on other pings", workflow::RecordingName(info));
  report::AddSyntheticCallout(report, info.synthetic, workflow::RecordingName(info));
  report.Paragraph(subject + ".");
  report::AddNoiseJudgement(report, judgement, info.synthetic);
  report::EndReport(report, provenance);
  return report;
}

cli::ExitStatus RunJudgeNoise(const JudgeNoiseOptions& options) {
  const ParameterSet parameters = data_io::ReadParameters(options.params);
  FittedPart part = ReadFittedPart(options.params);
  if (options.range_min_m || options.range_max_m) {
    part.window.range_min_m = options.range_min_m;
    part.window.range_max_m = options.range_max_m;
    part.left_out.clear();
  }
  const calib::NoiseLaw law{.display = parameters.display,
                            .receiver = parameters.receiver,
                            .speckle = options.speckle.value_or(part.speckle)};
  const auto recording = data_io::OpenRecording(options.real);
  const RecordingInfo& info = recording->info();
  const calib::NoiseCells cells = calib::NoiseCellsOf(info, part.window);
  std::optional<cli::RunOutput> output;
  if (!options.out.empty()) output.emplace(options.out, "judge-noise", options.common.force);
  std::vector<int> frames = options.frames.In(recording->frame_count());
  if (frames.empty()) {
    frames.resize(recording->frame_count());
    std::iota(frames.begin(), frames.end(), 0);
  }
  const calib::NoiseJudgement judgement =
      calib::JudgeNoise(law, *recording, frames, cells, WeightOf(part, cells, info));

  const std::string subject = fmt::format(
      "noise law {} on {} ping{}, without a fit; {:.2f} to {:.2f} m, {} speckle{}", options.params.string(),
      frames.size(), frames.size() == 1 ? "" : "s", cells.axes.range_edge_m(cells.first_bin),
      cells.axes.range_edge_m(cells.last_bin), ToString(law.speckle),
      part.file.empty() ? "; no fit.json of the law beside it states window and speckle"
                        : fmt::format("; window and speckle of {}", part.file.string()));
  Json json = {{"format", "sonar-noise-judgement/1"}};
  json.update(report::NoiseJudgementJson(judgement));
  if (output) {
    cli::Provenance provenance{.command = "judge-noise",
                               .configuration = ConfigurationJson(options, judgement, law.speckle),
                               .inputs = {options.params, options.real}};
    if (!part.file.empty()) provenance.inputs.push_back(part.file);
    data_io::WriteJson(*output / "judgement.json", json);
    cli::WriteProvenance(output->staging(), provenance);
    report::WriteReport(MakeReport(judgement, info, subject, cli::ProvenanceToJson(provenance)),
                        output->staging());
    output->Commit();
  }
  if (options.common.json) {
    cli::PrintJson(json);
  } else {
    cli::PrintResult(workflow::RecordingName(info) + ": " + subject + "\n" +
                     report::NoiseJudgementText(judgement));
    if (output) cli::PrintResult(fmt::format("report: {}\n", (options.out / "report.html").string()));
  }
  return cli::ExitStatus::kDone;
}

}  // namespace

void SetupJudgeNoise(CLI::App& app) {
  auto options = std::make_shared<JudgeNoiseOptions>();
  CLI::App* command = cli::AddCommand(
      app, "judge-noise", "Measures how well a fitted noise law describes pings, without fitting it again");
  command
      ->add_option(
          "--params", options->params,
          "Noise law, params.json of fit --noise-only; a fit.json beside it gives window and speckle")
      ->type_name("JSON")
      ->required();
  command->add_option("--real", options->real, "Recording with pings without targets")
      ->type_name("REC")
      ->required();
  cli::AddFrames(*command, options->frames, "Pings to judge");
  command->add_option("--range-min", options->range_min_m, "Nearest range used (default: that of the fit)")
      ->type_name("M");
  command->add_option("--range-max", options->range_max_m, "Farthest range used (default: that of the fit)")
      ->type_name("M");
  cli::AddChoice(*command, "--speckle", options->speckle,
                 "Speckle law (default: that of the fit, without fit.json gamma)");
  cli::AddOutFolder(*command, options->out, options->common,
                    "Folder for judgement.json and report.html (default: none is written)");
  cli::OnRun(command, options->common, [options] { return RunJudgeNoise(*options); });
}

}  // namespace sonarcal::commands
