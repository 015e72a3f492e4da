// `sonarcal convert FILE --out REC`: writes a recording of any readable format as a recording folder,
// optionally with the poses of the sonar from a file of poses or from a trajectory.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/cli/bag_options.h"
#include "apps/cli/choice_option.h"
#include "apps/cli/command.h"
#include "apps/cli/given_options.h"
#include "apps/cli/progress.h"
#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/cli/sonar_option.h"
#include "apps/commands/commands.h"
#include "apps/workflow/simulate.h"
#include "core/types/error.h"
#include "data_io/bag_trajectory.h"
#include "data_io/open_recording.h"
#include "data_io/pose_io.h"
#include "data_io/posed_recording.h"
#include "data_io/recordings/recalibrated_recording.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/recordings/salvaged_recording.h"
#include "data_io/recordings/selected_frames.h"
#include "data_io/trajectory_io.h"

namespace sonarcal::commands {
namespace {

struct ConvertOptions {
  cli::CommonOptions common;
  std::filesystem::path file;
  std::filesystem::path out;
  FrameList frames;                  // empty: all
  std::filesystem::path poses;       // one per frame that is converted; empty: poses as recorded
  std::filesystem::path trajectory;  // empty: poses as recorded
  std::optional<data_io::TrajectoryFormat> trajectory_format;  // absent: determined from its first lines
  std::string sonar;  // in place of that of the file; empty: as recorded
  cli::BagArguments bag;
  std::string pose_topic;       // topic of a ROS bag, in place of a trajectory
  std::string pose_frames;      // "WORLD:BODY", for a topic of transforms
  std::filesystem::path mount;  // empty: the trajectory is that of the sonar
  double time_offset_s = 0.0;   // added to the time of a frame before the look-up
  bool salvage = false;         // leaves out frames that cannot be read
  double most_gap_s = 1.0;      // max gap between poses for interpolation
};

// Reads world_from_body from a file or from the bag that is converted.
std::vector<data_io::TrajectoryPose> PosesOf(const ConvertOptions& options) {
  if (options.pose_topic.empty()) {
    const data_io::TrajectoryFormat format = options.trajectory_format
                                                 ? *options.trajectory_format
                                                 : data_io::GuessTrajectoryFormat(options.trajectory);
    return data_io::ReadTrajectory(options.trajectory, format);
  }
  data_io::BagPoseOptions of_bag{.topic = options.pose_topic, .most_gap_s = options.most_gap_s};
  if (!options.pose_frames.empty()) {
    const std::size_t colon = options.pose_frames.find(':');
    of_bag.world_frame = options.pose_frames.substr(0, colon);
    if (colon != std::string::npos) of_bag.body_frame = options.pose_frames.substr(colon + 1);
    if (of_bag.world_frame.empty() || of_bag.body_frame.empty())
      throw UsageError("--pose-frames is '{}', expected WORLD:BODY", options.pose_frames);
  }
  return data_io::ReadBagTrajectory(options.file, of_bag);
}

// Replaces the poses of the recording.
std::unique_ptr<data_io::PosedRecording> WithPoses(std::unique_ptr<RecordingSource> recording,
                                                   const ConvertOptions& options) {
  data_io::PosesOverTime poses{
      .world_from_body = PosesOf(options),
      .body_from_sonar = options.mount.empty() ? Pose{} : data_io::ReadMount(options.mount),
      .time_offset_s = options.time_offset_s,
      .most_gap_s = options.most_gap_s};
  return std::make_unique<data_io::PosedRecording>(std::move(recording), std::move(poses));
}

void CheckOptions(const ConvertOptions& options) {
  const bool takes_poses = !options.trajectory.empty() || !options.pose_topic.empty();
  if (takes_poses && !options.poses.empty())
    throw UsageError("--poses is given with --trajectory or --pose-topic, expected one of them");
  if (!takes_poses && !options.mount.empty())
    throw UsageError("--mount is given without --trajectory or --pose-topic, expected both");
  if (!options.trajectory.empty() && !options.pose_topic.empty())
    throw UsageError("--trajectory and --pose-topic are given, expected one of them");
  if (options.pose_topic.empty() && !options.pose_frames.empty())
    throw UsageError("--pose-frames is given without --pose-topic, expected both");
}

}  // namespace

cli::ExitStatus RunConvert(const ConvertOptions& options) {
  CheckOptions(options);
  cli::RefuseInputAsOutput(options.out, {data_io::LocateRecording(options.file), options.poses});
  std::unique_ptr<RecordingSource> recording = cli::OpenWithBagOptions(options.file, options.bag);
  const std::vector<int> selected = options.frames.In(recording->frame_count());
  recording = data_io::SelectFrames(std::move(recording), options.frames);
  std::optional<int> lost;
  if (options.salvage) {
    cli::Progress progress("Looking for damage", recording->frame_count(), options.common);
    auto salvaged = std::make_unique<data_io::SalvagedRecording>(
        std::move(recording), [&](int frames_done) { progress.Update(frames_done); });
    lost = salvaged->lost_count();
    recording = std::move(salvaged);
  }
  std::optional<int> posed;  // if poses are given
  if (!options.trajectory.empty() || !options.pose_topic.empty()) {
    auto with_poses = WithPoses(std::move(recording), options);
    posed = with_poses->posed_count();
    recording = std::move(with_poses);
  }

  if (!options.poses.empty()) {
    const std::vector<data_io::TimedPose> poses = data_io::ReadPosesOrRecording(options.poses);
    recording = data_io::WithPoses(std::move(recording), poses, options.poses);
    posed = static_cast<int>(poses.size());
  }
  if (!options.sonar.empty()) {
    recording = std::make_unique<data_io::RecalibratedRecording>(std::move(recording),
                                                                 workflow::ChooseSonar(options.sonar).sonar);
  }

  cli::RunOutput output(options.out, "convert", options.common.force);
  const int count = recording->frame_count();
  cli::Progress progress("Converting", count, options.common);
  data_io::WriteRecording(*recording, output.directory(),
                          {.progress = [&](int frames_done, int) { progress.Update(frames_done); }});
  cli::WriteProvenance(output.staging(),
                       {.command = "convert",
                        .configuration = {{"file", options.file.string()},
                                          {"sonar", options.sonar},
                                          {"out", options.out.string()},
                                          {"poses", options.poses.string()},
                                          {"trajectory", options.trajectory.string()},
                                          {"topic", options.bag.bag.topic},
                                          {"samples_by_range", options.bag.bag.message.sample_order ==
                                                                   data_io::SampleOrder::kByRange},
                                          {"picture_geometry", options.bag.picture_geometry.string()},
                                          {"mirrored", options.bag.bag.message.mirrored},
                                          {"pose_topic", options.pose_topic},
                                          {"pose_frames", options.pose_frames},
                                          {"mount", options.mount.string()},
                                          {"time_offset_s", options.time_offset_s},
                                          {"most_gap_s", options.most_gap_s},
                                          {"first_frame", selected.empty() ? 0 : selected.front()},
                                          {"salvage", options.salvage},
                                          {"frames", count},
                                          {"frame_list", options.frames.Text()}},
                        .inputs = {options.file, cli::SonarFile(options.sonar), options.poses,
                                   options.trajectory, options.mount, options.bag.picture_geometry}});
  output.Commit();

  if (options.common.json) {
    nlohmann::ordered_json json = {{"recording", output.final_path().string()}, {"frames", count}};
    if (lost) json["frames_lost"] = *lost;
    if (posed) json["frames_with_pose"] = *posed;
    cli::PrintJson(json);
  } else {
    cli::PrintResult(fmt::format("{}: {} {}{}{}\n", options.out.string(), count,
                                 count == 1 ? "frame" : "frames",
                                 posed ? fmt::format(", {} with a pose", *posed) : "",
                                 lost ? fmt::format(", {} left out that could not be read", *lost) : ""));
  }
  return cli::ExitStatus::kDone;
}

void SetupConvert(CLI::App& app) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* command =
      cli::AddCommand(app, "convert", "Writes any recording that can be read as a recording folder");
  command->add_option("FILE", options->file, "Recording folder, or file of a sonar's native format")
      ->required();
  cli::AddOutFolder(*command, options->out, options->common, "Recording folder to write")->required();
  cli::AddFrames(*command, options->frames, "Frames to convert");
  command
      ->add_option("--poses", options->poses,
                   "Poses, one per converted frame, in place of its own: a recording with poses, or a JSON "
                   "file (default: none)")
      ->type_name("REC|FILE");
  command
      ->add_option(
          "--trajectory", options->trajectory,
          fmt::format(
              "Trajectory of the sonar, or of the body that carries it; gives every frame the pose at "
              "its time, in place of its own. Columns: {}",
              data_io::kTrajectoryColumns))
      ->type_name("FILE");
  cli::AddChoice(*command, "--trajectory-format", options->trajectory_format,
                 "Format of the trajectory (default: determined from its first lines)");
  cli::AddSonarOfRecording(*command, options->sonar);
  cli::AddBagOptions(*command, options->bag);
  command
      ->add_option("--pose-topic", options->pose_topic,
                   "Topic of a ROS bag with the poses of that body, in place of --trajectory: Odometry, "
                   "PoseStamped or transforms")
      ->type_name("NAME");
  command
      ->add_option("--pose-frames", options->pose_frames,
                   "Frames between which the transforms are followed, of the world and of the body")
      ->type_name("WORLD:BODY");
  command
      ->add_option("--mount", options->mount,
                   "Mount of the sonar on that body: JSON with format sonar-mount/1 and body_from_sonar")
      ->type_name("FILE");
  command
      ->add_option("--time-offset", options->time_offset_s,
                   "Seconds to add to frame times to find them in the trajectory")
      ->type_name("S")
      ->capture_default_str();
  command
      ->add_option("--most-gap", options->most_gap_s,
                   "Max time in seconds between two poses of the trajectory for an interpolation")
      ->type_name("S")
      ->capture_default_str()
      ->check(CLI::PositiveNumber.description(""));
  command->add_flag("--salvage", options->salvage,
                    "Leave out the frames of a damaged recording that cannot be read, with a message for "
                    "each, instead of ending at the first");
  cli::OnRun(command, options->common, [command, options] {
    if (options->trajectory.empty()) {
      cli::RefuseGiven(*command, {"--trajectory-format"}, "without --trajectory");
      if (options->pose_topic.empty())
        cli::RefuseGiven(*command, {"--time-offset", "--most-gap"}, "without --trajectory or --pose-topic");
    }
    return RunConvert(*options);
  });
}

}  // namespace sonarcal::commands
