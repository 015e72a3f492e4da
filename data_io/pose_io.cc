#include "data_io/pose_io.h"

#include <nlohmann/json.hpp>

#include "data_io/json/json_fields.h"
#include "data_io/json/json_reader.h"
#include "data_io/json/json_writer.h"
#include "data_io/open_recording.h"
#include "data_io/recordings/recording_io.h"

namespace sonarcal::data_io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kFormat = "sonar-poses/1";

JsonReader ListOfPoses(const JsonReader& json) {
  if (json.is_array()) return json;
  json.CheckFormat(kFormat);
  return json.At("poses");
}

}  // namespace

std::vector<TimedPose> ReadPoses(const std::filesystem::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  const JsonReader list = ListOfPoses(json);
  std::vector<TimedPose> poses;
  for (const JsonReader& pose : list.Items()) {
    poses.push_back({pose.FindNumber("time_s"), ReadPose(pose.At("world_from_sonar"))});
  }
  json.Finish();
  if (poses.empty()) list.Fail("is empty, expected at least one pose");
  return poses;
}

std::vector<TimedPose> PosesOfRecording(const RecordingSource& recording) {
  std::vector<TimedPose> poses;
  for (int index = 0; index < recording.frame_count(); ++index) {
    const FrameInfo frame = recording.frame_info(index);
    if (!frame.world_from_sonar) {
      throw DataError("{}: frame {} ({}) has no 'world_from_sonar', expected a pose with every frame",
                      recording.info().source, index, frame.name);
    }
    poses.push_back({frame.time_s, *frame.world_from_sonar});
  }
  return poses;
}

std::vector<TimedPose> ReadPosesOrRecording(const std::filesystem::path& path) {
  if (IsRecordingFolder(path)) return PosesOfRecording(*OpenRecordingFolder(path));
  if (path.extension() == ".json") return ReadPoses(path);
  return PosesOfRecording(*OpenRecording(path));
}

void WritePoses(const std::filesystem::path& file, const std::vector<TimedPose>& poses) {
  Json list = Json::array();
  for (const TimedPose& pose : poses) {
    Json json;
    if (pose.time_s) json["time_s"] = *pose.time_s;
    json["world_from_sonar"] = PoseJson(pose.world_from_sonar);
    list.push_back(std::move(json));
  }
  WriteJson(file, {{"format", kFormat}, {"poses", std::move(list)}});
}

}  // namespace sonarcal::data_io
