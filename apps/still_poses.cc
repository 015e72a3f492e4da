#include "apps/still_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "apps/compare_recordings.h"
#include "apps/fit_command.h"
#include "apps/fit_recording.h"
#include "apps/provenance.h"
#include "apps/report/comparison_section.h"
#include "apps/report/report_end.h"
#include "apps/report/still_section.h"
#include "apps/run_output.h"
#include "core/types/error.h"
#include "data_io/files/atomic_output.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "sim/physics/receiver.h"

namespace sonarcal {
namespace {

constexpr double kAgreeSigmas = 3.0;

// Where the floor names no level, it is the same everywhere.
std::vector<double> NoiseShapeDb(const ReceiverParameters& receiver, const PolarAxes& axes,
                                 double absorption_db_per_m) {
  if (!receiver.noise_db) return {};
  const ReceiverNoise noise(receiver, axes, absorption_db_per_m);
  std::vector<double> shape_db;
  for (int bin = 0; bin < axes.range_bins; ++bin) {
    for (int beam = 0; beam < axes.beam_count(); ++beam)
      shape_db.push_back(LevelOfPower(noise.Power(bin, beam)) - *receiver.noise_db);
  }
  return shape_db;
}

ParameterSet ParametersFor(const FitCommandOptions& options, const RecordingInfo& info) {
  ParameterSet parameters;
  parameters.model = EchoModel::kAcoustic;
  if (!options.params.empty()) parameters = ReadParameters(options.params);
  if (options.params.empty() && !(info.scale.db_min && info.scale.db_max)) {
    throw DataError("{}: the recording tells no levels db_min and db_max, expected --params with a display",
                    info.source);
  }
  if (const std::string note = TakeDisplay(info.scale, parameters); !note.empty())
    PrintNote(options.common, note);
  return parameters;
}

FitReport ReportOf(const StillPoses& still) {
  FitReport report;
  // Poses by themselves: what they say together is their mean, weighed by what each knows.
  double weights = 0.0;
  double sum = 0.0;
  for (const StillPose& pose : still.poses) {
    const double weight = std::pow(pose.levels.noise_sigma_db, -2);
    weights += weight;
    sum += weight * pose.levels.noise_db;
    report.frames_used.insert(report.frames_used.end(), pose.levels.frames.begin(), pose.levels.frames.end());
  }
  std::sort(report.frames_used.begin(), report.frames_used.end());
  const double noise_db = sum / weights;
  report.parameters.push_back({.name = "receiver.noise_db",
                               .unit = "dB",
                               .value = noise_db,
                               .sigma = 1.0 / std::sqrt(weights),
                               .initial = noise_db,
                               .lower = -300.0,
                               .upper = 300.0,
                               .status = ParameterStatus::kFree});
  report.termination = "converged";
  report.gauge.push_back("display and looks as given: noise is told in their levels");
  return report;
}

}  // namespace

std::optional<double> StillPose::NoiseDeviation() const {
  if (!fitted_noise_db) return std::nullopt;
  return (*fitted_noise_db - levels.noise_db) /
         std::hypot(levels.noise_sigma_db, fitted_noise_sigma_db.value_or(0.0));
}

bool StillPose::NoiseAgrees() const {
  const std::optional<double> deviation = NoiseDeviation();
  return deviation && std::abs(*deviation) <= kAgreeSigmas;
}

std::vector<std::vector<int>> FramesByPose(const RecordingSource& recording) {
  std::vector<std::pair<std::optional<Pose>, std::vector<int>>> groups;
  for (int frame = 0; frame < recording.frame_count(); ++frame) {
    const std::optional<Pose> pose = recording.frame_info(frame).world_from_sonar;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      return group.first.has_value() == pose.has_value() && (!pose || IsSamePose(*group.first, *pose));
    });
    if (same == groups.end()) {
      groups.push_back({pose, {frame}});
    } else {
      same->second.push_back(frame);
    }
  }
  std::vector<std::vector<int>> shown_again;
  for (auto& [pose, frames] : groups) {
    if (frames.size() > 1) shown_again.push_back(std::move(frames));
  }
  return shown_again;
}

StillPoses TellStillPoses(const RecordingSource& recording, const ParameterSet& parameters,
                          double absorption_db_per_m, const std::vector<std::uint8_t>& use,
                          const FitReport* report, const ExpectedEchoes& expected) {
  const StillOptions options{
      .display = parameters.display,
      .looks = parameters.receiver.looks,
      .noise_shape_db = NoiseShapeDb(parameters.receiver, recording.info().sonar.axes, absorption_db_per_m),
      .use = use};
  StillPoses still;
  for (const std::vector<int>& frames : FramesByPose(recording)) {
    std::vector<PolarImage> images;
    for (const int frame : frames) images.push_back(recording.ReadFrame(frame).image);
    StillPose pose;
    try {
      pose.levels = TellSpeckleFromNoise(images, frames, options);
    } catch (const DataError& error) {
      still.refused.emplace_back(error.what());
      continue;
    }
    if (report != nullptr && parameters.receiver.noise_db) {
      pose.fitted_noise_db = parameters.receiver.noise_db;
      const FittedParameter* noise = report->Find("receiver.noise_db");
      if (noise != nullptr) pose.fitted_noise_sigma_db = noise->sigma;
    }
    if (expected) {
      try {
        pose.scene = CompareSceneEchoes(pose.levels, expected(frames.front()), options);
      } catch (const DataError& error) {
        still.refused.emplace_back(error.what());
      }
    }
    still.poses.push_back(std::move(pose));
  }
  return still;
}

ExitStatus RunFitStill(const FitCommandOptions& options) {
  using Json = nlohmann::ordered_json;
  const auto recording = OpenRecording(options.real);
  ParameterSet parameters = ParametersFor(options, recording->info());
  RunOutput output(options.out, "fit", options.common.force);
  const StillPoses still = TellStillPoses(*recording, parameters, 0.0, {});
  if (still.poses.empty()) {
    throw DataError("{}: {}", options.real.string(),
                    still.refused.empty() ? "no pose is shown by two frames" : still.refused.front());
  }
  Provenance provenance{.command = "fit",
                        .configuration = {{"still", true},
                                          {"real", options.real.string()},
                                          {"params", options.params.string()},
                                          {"out", options.out.string()}},
                        .inputs = {options.real}};
  if (!options.params.empty()) provenance.inputs.push_back(options.params);
  const FitReport report = ReportOf(still);
  const std::string fit_json = FitReportJson(report, StillMembers(still));
  WriteFileWhole(output / "fit.json", fit_json);
  WriteProvenance(output.staging(), provenance);
  parameters.receiver.noise_db = report.parameters.front().value;
  parameters.materials.try_emplace("default");
  WriteParameters(output / "params.json", parameters);
  const RecordingInfo& info = recording->info();
  HtmlReport html("Speckle and noise of still frames", RecordingName(info));
  AddSyntheticCallout(html, info.synthetic, RecordingName(info));
  html.Section("Levels");
  AddStillPoses(html, still);
  EndReport(html, ProvenanceToJson(provenance));
  html.Write(output / "report.html");
  output.Commit();
  if (options.common.json) {
    PrintJson(Json::parse(fit_json));
  } else {
    PrintResult(RecordingName(info) + "\n" + StillText(still) +
                fmt::format("report: {}\n", (options.out / "report.html").string()));
  }
  return ExitStatus::kDone;
}

}  // namespace sonarcal
