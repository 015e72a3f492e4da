#include "apps/reproduce/prepared_recording.h"

#include "core/types/error.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/scenes/scene_io.h"

namespace sonarcal::reproduce {
namespace {

std::string RecordingName(const CasePlan& plan) {
  if (const auto* target = std::get_if<TargetCase>(&plan.study)) return target->recording;
  if (const auto* surface = std::get_if<MarkedSurfaceCase>(&plan.study)) return surface->recording;
  throw UsageError("the case '{}' has no recording that lacks scene and poses, expected another case",
                   plan.name);
}

}  // namespace

std::filesystem::path ImagesOf(const CasePlan& plan, const std::filesystem::path& recordings) {
  std::filesystem::path folder = recordings / RecordingName(plan);
  if (!std::filesystem::is_directory(folder)) {
    throw DataError(
        "{}: no such folder; `sonarcal recordings` says where recordings come from, and "
        "SONARCAL_RECORDINGS or --recordings where they are",
        folder.string());
  }
  return folder;
}

PreparedRecording PrepareCase(const CasePlan& plan, const std::filesystem::path& recordings,
                              const PrepareOptions& options) {
  const std::filesystem::path images = ImagesOf(plan, recordings);
  PreparedRecording prepared = std::holds_alternative<TargetCase>(plan.study)
                                   ? PrepareTarget(plan, images, options)
                                   : PrepareMarkedSurface(plan, images, options);
  std::vector<std::string>& caveats = prepared.caveats;
  caveats.insert(caveats.begin(), plan.caveats.begin(), plan.caveats.end());
  for (std::string& sentence : KnownSentences(plan)) caveats.push_back(std::move(sentence));
  return prepared;
}

void WritePrepared(const PreparedRecording& prepared, const std::filesystem::path& folder) {
  const RecordingSource& recording = *prepared.recording;
  RecordingInfo info = recording.info();
  info.scene_path = (folder / "scene.gltf").string();
  for (const std::string& caveat : prepared.caveats) info.notes.push_back(caveat);
  std::vector<Frame> frames;
  for (int i = 0; i < recording.frame_count(); ++i) frames.push_back(recording.ReadFrame(i));
  data_io::WriteRecording(MemoryRecording(std::move(info), std::move(frames)), folder);
  data_io::WriteGltf(prepared.scene, folder / "scene.gltf");
  data_io::WriteParameters(folder / "params.json", prepared.parameters);
}

}  // namespace sonarcal::reproduce
