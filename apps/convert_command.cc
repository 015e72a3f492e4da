#include "apps/convert_command.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/choice_option.h"
#include "apps/commands.h"
#include "apps/frame_range.h"
#include "apps/progress.h"
#include "apps/provenance.h"
#include "apps/run_output.h"
#include "data_io/open_recording.h"
#include "data_io/posed_recording.h"
#include "data_io/recording_io.h"
#include "data_io/types/error.h"

namespace sonarcal {
namespace {

constexpr JsonWords<TrajectoryFormat, 3> kTrajectoryFormats = {
    {{"tum", TrajectoryFormat::kTum}, {"euroc", TrajectoryFormat::kEuroc}, {"csv", TrajectoryFormat::kCsv}}};

// The recording with poses from a trajectory in place of its own.
std::unique_ptr<PosedRecording> WithTrajectory(std::unique_ptr<RecordingSource> recording,
                                               const ConvertOptions& options) {
  const TrajectoryFormat format =
      options.trajectory_format ? *options.trajectory_format : GuessTrajectoryFormat(options.trajectory);
  PosesOverTime poses{.world_from_body = ReadTrajectory(options.trajectory, format),
                      .body_from_sonar = options.mount.empty() ? Pose{} : ReadMount(options.mount),
                      .time_offset_s = options.time_offset_s,
                      .most_gap_s = options.most_gap_s};
  return std::make_unique<PosedRecording>(std::move(recording), std::move(poses));
}

}  // namespace

ExitStatus RunConvert(const ConvertOptions& options) {
  if (options.trajectory.empty() && !options.mount.empty())
    throw UsageError("--mount is given without --trajectory, expected both");
  std::unique_ptr<RecordingSource> recording = OpenRecording(options.file);
  const FrameRange range = ParseFrameRange(options.frames, recording->frame_count());
  recording = std::make_unique<FrameRangeView>(std::move(recording), range);
  std::optional<int> posed;  // where a trajectory gives poses
  if (!options.trajectory.empty()) {
    auto with_poses = WithTrajectory(std::move(recording), options);
    posed = with_poses->posed_count();
    recording = std::move(with_poses);
  }

  RunOutput output(options.out);
  Progress progress("Converting", range.count(), options.common);
  WriteRecording(*recording, output.directory(),
                 {.progress = [&](int frames_done, int) { progress.Update(frames_done); }});
  std::vector<std::filesystem::path> inputs = {options.file};
  for (const auto* input : {&options.trajectory, &options.mount}) {
    if (!input->empty()) inputs.push_back(*input);
  }
  WriteProvenance(output.staging(), {.command = "convert",
                                     .configuration = {{"file", options.file.string()},
                                                       {"out", options.out.string()},
                                                       {"trajectory", options.trajectory.string()},
                                                       {"mount", options.mount.string()},
                                                       {"time_offset_s", options.time_offset_s},
                                                       {"most_gap_s", options.most_gap_s},
                                                       {"first_frame", range.begin},
                                                       {"frames", range.count()}},
                                     .inputs = inputs});
  output.Commit();

  if (options.common.json) {
    nlohmann::ordered_json json = {{"recording", output.final_path().string()}, {"frames", range.count()}};
    if (posed) json["frames_with_pose"] = *posed;
    PrintJson(json);
  } else {
    PrintResult(fmt::format("{}: {} {}{}\n", options.out.string(), range.count(),
                            range.count() == 1 ? "frame" : "frames",
                            posed ? fmt::format(", {} with a pose", *posed) : ""));
  }
  return ExitStatus::kDone;
}

void SetupConvert(CLI::App& app) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* command =
      AddCommand(app, "convert", "Writes any recording that can be read as a recording folder");
  command->add_option("FILE", options->file, "Recording folder, or file of a sonar's native format")
      ->required();
  command->add_option("--out", options->out, "Recording folder to write")->type_name("DIR")->required();
  command
      ->add_option("--frames", options->frames,
                   "Frames to take: from A, counted from 0, up to but without B; all if not given")
      ->type_name("A:B");
  command
      ->add_option(
          "--trajectory", options->trajectory,
          "Where the sonar, or the body that carries it, was over time; gives every frame the pose at its "
          "time, in place of its own")
      ->type_name("FILE");
  AddChoice(*command, "--trajectory-format", options->trajectory_format, kTrajectoryFormats,
            "Format of the trajectory (default: told by its first lines)");
  command->add_option("--mount", options->mount, "How the sonar sits on that body (sonar-mount/1)")
      ->type_name("FILE");
  command
      ->add_option("--time-offset", options->time_offset_s,
                   "Seconds to add to frame times to find them in the trajectory")
      ->type_name("S")
      ->capture_default_str();
  command
      ->add_option("--most-gap", options->most_gap_s,
                   "Seconds between two poses of the trajectory beyond which nothing is interpolated")
      ->type_name("S")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  OnRun(command, options->common, [options] { return RunConvert(*options); });
}

}  // namespace sonarcal
