#include "data_io/pose_io.h"

#include <nlohmann/json.hpp>

#include "data_io/files/atomic_output.h"
#include "data_io/json/json_fields.h"
#include "data_io/json/json_reader.h"
#include "data_io/json/json_writer.h"
#include "data_io/open_recording.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/recordings/view_recording.h"

namespace sonarcal::data_io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kFormat = "sonar-poses/1";

JsonReader ListOfPoses(const JsonReader& json) {
  if (json.is_array()) return json;
  json.CheckFormat(kFormat);
  return json.At("poses");
}

PoseFound ReadFound(const JsonReader& json) {
  return {.what = json.At("what").String(),
          .world_from_sonar = ReadPose(json.At("world_from_sonar")),
          .rms_difference = json.At("rms_difference").Number(),
          .gain_db = json.At("gain_db").Number(),
          .worse_by_nats = json.At("worse_by_nats").Number(),
          .worse_by_sigmas = json.At("worse_by_sigmas").Number(),
          .explains_as_well = json.At("explains_as_well").Bool()};
}

Json FoundJson(const PoseFound& found) {
  return {{"what", found.what},
          {"world_from_sonar", PoseJson(found.world_from_sonar)},
          {"rms_difference", found.rms_difference},
          {"gain_db", found.gain_db},
          {"worse_by_nats", found.worse_by_nats},
          {"worse_by_sigmas", found.worse_by_sigmas},
          {"explains_as_well", found.explains_as_well}};
}

TimedPose ReadTimedPose(const JsonReader& json) {
  TimedPose pose{json.FindNumber("time_s"), ReadPose(json.At("world_from_sonar"))};
  if (const auto motion = json.Find("motion")) pose.motion = ReadMotion(*motion);
  constexpr int kMaxFrame = 1'000'000'000;
  if (const auto frame = json.Find("frame")) pose.frame = static_cast<int>(frame->Integer(0, kMaxFrame));
  if (const auto candidates = json.Find("candidates")) {
    for (const JsonReader& found : candidates->Items()) pose.candidates.push_back(ReadFound(found));
  }
  if (const auto open = json.Find("open")) {
    for (const JsonReader& sentence : open->Items()) pose.open.push_back(sentence.String());
  }
  return pose;
}

}  // namespace

std::vector<TimedPose> ReadPoses(const std::filesystem::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  const JsonReader list = ListOfPoses(json);
  std::vector<TimedPose> poses;
  for (const JsonReader& pose : list.Items()) {
    poses.push_back(ReadTimedPose(pose));
  }
  json.Finish();
  if (poses.empty()) list.Fail("is empty, expected at least one pose");
  return poses;
}

std::vector<TimedPose> WithMotion(std::vector<TimedPose> poses, const PingPattern& pings) {
  if (!pings.is_timed()) return poses;
  const auto gap_s = [&](std::size_t first, std::size_t last) {
    if (!poses[first].time_s || !poses[last].time_s) return 0.0;
    const double time_s = *poses[last].time_s - *poses[first].time_s;
    return time_s > 0.0 && time_s <= kMaxMotionGapS * static_cast<double>(last - first) ? time_s : 0.0;
  };
  std::vector<std::optional<Motion>> motions;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::size_t first = i > 0 && gap_s(i - 1, i) > 0.0 ? i - 1 : i;
    const std::size_t last = i + 1 < poses.size() && gap_s(i, i + 1) > 0.0 ? i + 1 : i;
    motions.push_back(poses[i].motion);
    if (motions.back() || first == last) continue;
    motions.back() = MotionBetween(poses[first].world_from_sonar, poses[last].world_from_sonar,
                                   poses[i].world_from_sonar, gap_s(first, last));
  }
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].motion = motions[i];
  return poses;
}

std::vector<Pose> PosesAlone(const std::vector<TimedPose>& poses) {
  std::vector<Pose> alone;
  for (const TimedPose& pose : poses) alone.push_back(pose.world_from_sonar);
  return alone;
}

std::vector<TimedPose> PosesOfRecording(const RecordingSource& recording) {
  std::vector<TimedPose> poses;
  for (int index = 0; index < recording.frame_count(); ++index) {
    const FrameInfo frame = recording.frame_info(index);
    if (!frame.world_from_sonar) {
      throw DataError("{}: frame {} ({}) has no 'world_from_sonar', expected a pose with every frame",
                      recording.info().source, index, frame.name);
    }
    poses.push_back({frame.time_s, *frame.world_from_sonar, frame.motion});
  }
  return WithMotion(std::move(poses), recording.info().sonar.pings);
}

std::vector<TimedPose> ReadPosesOrRecording(const std::filesystem::path& path) {
  if (IsRecordingFolder(path)) return PosesOfRecording(*OpenRecordingFolder(path));
  if (path.extension() == ".json") return ReadPoses(path);
  if (path.extension() == ".csv" || path.extension() == ".txt") {
    throw DataError(
        "{}: a table, expected a recording with poses or a JSON file; for a trajectory, `sonarcal convert "
        "--trajectory` gives each frame a pose by its time",
        path.string());
  }
  return PosesOfRecording(*OpenRecording(path));
}

std::unique_ptr<RecordingSource> WithPoses(std::shared_ptr<const RecordingSource> recording,
                                           const std::vector<TimedPose>& poses,
                                           const std::filesystem::path& source) {
  if (recording->frame_count() != static_cast<int>(poses.size())) {
    throw DataError("{} has {} frames and {} has {} poses, expected as many", recording->info().source,
                    recording->frame_count(), source.string(), poses.size());
  }
  std::vector<std::optional<Pose>> of_frames;
  std::vector<std::optional<Motion>> motions;
  for (const TimedPose& pose : poses) {
    of_frames.emplace_back(pose.world_from_sonar);
    motions.push_back(pose.motion);
  }
  return std::make_unique<ReposedRecording>(std::move(recording), std::move(of_frames), std::move(motions));
}

std::string PosesText(const std::vector<TimedPose>& poses) {
  Json list = Json::array();
  for (const TimedPose& pose : poses) {
    Json json;
    if (pose.time_s) json["time_s"] = *pose.time_s;
    json["world_from_sonar"] = PoseJson(pose.world_from_sonar);
    if (pose.motion) json["motion"] = MotionJson(*pose.motion);
    if (pose.frame) json["frame"] = *pose.frame;
    for (const PoseFound& found : pose.candidates) json["candidates"].push_back(FoundJson(found));
    if (!pose.open.empty()) json["open"] = pose.open;
    list.push_back(std::move(json));
  }
  return JsonText({{"format", kFormat}, {"poses", std::move(list)}});
}

void WritePoses(const std::filesystem::path& file, const std::vector<TimedPose>& poses) {
  WriteFileWhole(file, PosesText(poses));
}

}  // namespace sonarcal::data_io
