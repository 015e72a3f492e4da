// `sonarcal judge-noise`: judges a noise law that `fit --noise-only` wrote on other pings, without a fit
// (calib/noise/noise_judgement.h). Prints the figures, and with --out writes judgement.json and a report.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/command.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/commands/commands.h"
#include "apps/report/detection/false_alarm_section.h"
#include "apps/report/html/paper_files.h"
#include "apps/report/html/report_end.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/report/sections/noise_section.h"
#include "apps/workflow/compare.h"
#include "apps/workflow/noise/judge_noise.h"
#include "core/types/error.h"
#include "data_io/json/json_writer.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::commands {
namespace {

using Json = nlohmann::ordered_json;

struct JudgeNoiseCommandOptions {
  cli::CommonOptions common;
  std::filesystem::path params;
  std::filesystem::path real;
  std::filesystem::path out;  // empty: only the figures are printed
  FrameList frames;           // empty: all
  workflow::JudgeNoiseOptions judge;
};

Json ConfigurationJson(const JudgeNoiseCommandOptions& options, const calib::NoiseJudgement& judgement,
                       sim::SpeckleLaw speckle) {
  const PolarAxes& axes = judgement.cells.axes;
  return {{"params", options.params.string()},
          {"real", options.real.string()},
          {"out", options.out.string()},
          {"frames", judgement.frames},
          {"range_m",
           {axes.range_edge_m(judgement.cells.first_bin), axes.range_edge_m(judgement.cells.last_bin)}},
          {"speckle", ToString(speckle)},
          {"false_alarms", options.judge.false_alarms}};
}

report::HtmlReport MakeReport(const workflow::JudgedNoise& judged, const RecordingInfo& info,
                              const std::string& subject, const Json& provenance) {
  report::HtmlReport report("Noise law on other pings", workflow::RecordingName(info));
  report::AddSyntheticCallout(report, info.synthetic, workflow::RecordingName(info));
  report.Paragraph(subject + ".");
  report::AddNoiseJudgement(report, judged.judgement, info.synthetic);
  report::AddFalseAlarms(report, judged.false_alarms);
  report::EndReport(report, provenance);
  return report;
}

// States the source of the window and the speckle law that no option gives. Empty if options give both.
std::string SourceText(const workflow::JudgeNoiseOptions& judge, const std::filesystem::path& fit) {
  std::vector<std::string> parts;
  if (!judge.range_min && !judge.range_max) {
    parts.emplace_back("window");
  } else if (!judge.range_min) {
    parts.emplace_back("nearest range");
  } else if (!judge.range_max) {
    parts.emplace_back("farthest range");
  }
  if (!judge.speckle) parts.emplace_back("speckle");
  if (parts.empty()) return {};
  const std::string names = fmt::format("{}", fmt::join(parts, " and "));
  return fit.empty() ? fmt::format("; no fit.json of the law beside it states {}", names)
                     : fmt::format("; {} of {}", names, fit.string());
}

cli::ExitStatus RunJudgeNoise(const JudgeNoiseCommandOptions& options) {
  const ParameterSet parameters = data_io::ReadParameters(options.params);
  const workflow::FittedNoiseWindow fitted = workflow::ReadFittedWindow(options.params);
  const auto recording = data_io::OpenRecording(options.real);
  const RecordingInfo& info = recording->info();
  const std::vector<int> frames = options.frames.In(recording->frame_count());
  std::optional<cli::RunOutput> output;
  if (!options.out.empty()) output.emplace(options.out, "judge-noise", options.common.force);
  std::optional<cli::Progress> progress;
  std::string shown;
  const workflow::JudgedNoise judged =
      workflow::JudgeNoise(*recording, parameters, frames, options.judge, fitted,
                           {.progress =
                                [&](const std::string& step, int done, int total) {
                                  if (step != shown) progress.emplace(step, total, options.common, "pings");
                                  shown = step;
                                  progress->Update(done);
                                },
                            .message = {},
                            .stop = {}});
  progress.reset();
  const calib::NoiseJudgement& judgement = judged.judgement;
  const calib::NoiseCells& cells = judgement.cells;

  const std::string subject =
      fmt::format("noise law {} on {} ping{}, without a fit; {:.2f} to {:.2f} m, {} speckle{}",
                  options.params.string(), judgement.frames.size(), judgement.frames.size() == 1 ? "" : "s",
                  cells.axes.range_edge_m(cells.first_bin), cells.axes.range_edge_m(cells.last_bin),
                  ToString(judged.law.speckle), SourceText(options.judge, fitted.file));
  Json json = report::NoiseJudgementFileJson(judgement);
  if (options.judge.false_alarms) json["false_alarms"] = report::FalseAlarmsJson(judged.false_alarms);
  if (output) {
    cli::Provenance provenance{.command = "judge-noise",
                               .configuration = ConfigurationJson(options, judgement, judged.law.speckle),
                               .inputs = {options.params, options.real}};
    if (!fitted.file.empty()) provenance.inputs.push_back(fitted.file);
    data_io::WriteJson(*output / "judgement.json", json);
    cli::WriteProvenance(output->staging(), provenance);
    report::WriteReport(MakeReport(judged, info, subject, cli::ProvenanceToJson(provenance)),
                        output->staging());
    output->Commit();
  }
  if (options.common.json) {
    cli::PrintJson(json);
  } else {
    cli::PrintResult(workflow::RecordingName(info) + ": " + subject + "\n" +
                     report::NoiseJudgementText(judgement, info.synthetic) +
                     report::FalseAlarmsText(judged.false_alarms));
    if (output) cli::PrintResult(fmt::format("report: {}\n", (options.out / "report.html").string()));
  }
  return cli::ExitStatus::kDone;
}

}  // namespace

void SetupJudgeNoise(CLI::App& app) {
  auto options = std::make_shared<JudgeNoiseCommandOptions>();
  CLI::App* command =
      cli::AddCommand(app, "judge-noise", "Measures how well a fitted noise law describes other pings");
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
  cli::AddOptions(*command, options->judge);
  cli::AddOutFolder(*command, options->out, options->common,
                    "Folder for judgement.json and report.html (default: none is written)");
  cli::OnRun(command, options->common, [options] { return RunJudgeNoise(*options); });
}

}  // namespace sonarcal::commands
