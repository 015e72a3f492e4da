#include "apps/reproduce/known_recording.h"

#include "core/types/error.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/scenes/scene_io.h"

namespace sonarcal::reproduce {
namespace {

std::filesystem::path FolderOf(const std::filesystem::path& recordings, const char* name) {
  std::filesystem::path folder = recordings / name;
  if (!std::filesystem::is_directory(folder)) {
    throw DataError(
        "{}: no such folder; `sonarcal recordings` says where recordings come from, and "
        "SONARCAL_RECORDINGS or --recordings where they are",
        folder.string());
  }
  return folder;
}

}  // namespace

PreparedRecording PrepareKnown(KnownRecording known, const std::filesystem::path& recordings,
                               const PrepareOptions& options) {
  switch (known) {
    case KnownRecording::kBomb:
      return PrepareBombRecording(FolderOf(recordings, "aris3000_uxo"), options);
    case KnownRecording::kHullStrip:
      return PrepareHullRecording(FolderOf(recordings, "didson_hull"), options);
  }
  SONARCAL_CHECK(false, "known recording {}", static_cast<int>(known));
  return {};
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
