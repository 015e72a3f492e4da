#include "data_io/open_recording.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/files/folder_moves.h"
#include "data_io/pictures/picture_io.h"
#include "data_io/recordings/levelled_recording.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/ros/bag_recording.h"
#include "data_io/sonars/aris_io.h"
#include "data_io/sonars/ddf_io.h"
#include "data_io/sonars/dfki_uxo_io.h"
#include "data_io/sonars/didson_io.h"
#include "data_io/sonars/neusis_io.h"
#include "data_io/sonars/oculus_io.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

struct Format {
  const char* description;  // for the list of supported formats
  bool (*is)(const std::filesystem::path&);
  std::unique_ptr<RecordingSource> (*open)(const std::filesystem::path&);
};

// The first format that accepts the path opens it.
constexpr Format kFormats[] = {
    {"a recording folder (recording.json)", IsRecordingFolder, OpenRecordingFolder},
    // Before formats that are recognised by names of pictures: a geometry file is more specific.
    {"pictures with their geometry (NAME.geometry.json, geometry.json)", HasPictureGeometry,
     OpenPictureRecording},
    {"ARIS v5 (.aris)", IsAris, OpenAris},
    {"DIDSON v3 or v4 (.ddf)", IsDdf, OpenDdf},
    {"Oculus simple ping results", IsOculus, OpenOculus},
    {"DIDSON pings (<microseconds>.png and .json)", IsDidson, OpenDidson},
    {"a recording of the DFKI UXO data set (aris_frame_meta.csv, aris_raw)", IsDfkiUxo, OpenDfkiUxo},
    {"pickles of NeuSIS (Config.json, .pkl)", IsNeusis, OpenNeusis},
    {"a ROS bag with a sonar's topic (.bag, .mcap, .db3)", IsBag, OpenBag},
};
// Last, because it accepts any picture, also those of the formats above.
constexpr Format kPictures = {"pictures or a video of a viewer (PNG, JPEG, AVI, MP4)", IsPictures,
                              OpenPictureRecording};

const Format* FormatOf(const fs::path& path) {
  const auto* const format =
      std::ranges::find_if(kFormats, [&](const Format& candidate) { return candidate.is(path); });
  return format == std::end(kFormats) ? nullptr : format;
}

// False for a file that cannot be opened, too: it must not hide a recording beside it.
bool IsRecording(const fs::path& entry) {
  try {
    return FormatOf(entry) != nullptr;
  } catch (const DataError&) {
    return false;
  }
}

// Files and subfolders that are recordings, by name. Pictures count only as a video, because other folders
// hold pictures too.
std::vector<fs::path> RecordingsIn(const fs::path& folder) {
  constexpr std::size_t kMaxEntries = 10'000;
  std::vector<fs::path> entries;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const bool hidden = entry.path().filename().string().starts_with('.');
    if (!hidden && (entry.is_regular_file(error) || entry.is_directory(error))) entries.push_back(entry);
    if (entries.size() == kMaxEntries) break;
  }
  std::ranges::sort(entries);
  const bool has_pictures = IsPictures(folder);
  std::erase_if(entries, [&](const fs::path& entry) {
    const bool is_video = !has_pictures && fs::is_regular_file(entry, error) && IsPictures(entry);
    return !IsRecording(entry) && !is_video;
  });
  return entries;
}

// Recording that was found in a folder, with a note about it.
class FoundRecording final : public RecordingSource {
 public:
  FoundRecording(std::unique_ptr<RecordingSource> recording, const fs::path& found)
      : recording_(std::move(recording)), info_(recording_->info()) {
    info_.notes.insert(info_.notes.begin(),
                       fmt::format("The folder holds one recording, {}, which was opened.",
                                   Printable(found.filename().string())));
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return recording_->frame_count(); }
  FrameInfo frame_info(int index) const override { return recording_->frame_info(index); }
  Frame ReadFrame(int index) const override { return recording_->ReadFrame(index); }

 private:
  std::unique_ptr<RecordingSource> recording_;
  RecordingInfo info_;
};

}  // namespace

fs::path LocateRecording(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error) || FormatOf(path) != nullptr) return path;
  const std::vector<fs::path> found = RecordingsIn(path);
  if (found.empty()) return path;
  if (found.size() == 1) return found.front();
  constexpr std::size_t kMaxNamed = 20;
  std::string names;
  for (std::size_t i = 0; i < std::min(found.size(), kMaxNamed); ++i)
    names += (i == 0 ? "" : ", ") + Printable(found[i].filename().string());
  throw DataError("{}: the folder holds {} recordings, expected the path of one of them: {}{}", path.string(),
                  found.size(), names, found.size() > kMaxNamed ? ", ..." : "");
}

std::unique_ptr<RecordingSource> OpenRecording(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw DataError("{}: no such file or folder", path.string());
  const fs::path located = LocateRecording(path);
  const fs::path folder =
      fs::canonical(fs::is_directory(located) ? located : fs::absolute(located).parent_path(), error);
  if (!error && HasUnfinishedMoves(folder)) {
    throw DataError(
        "{}: a run that was killed, or is under way, has moved only a part of its files here; run it again",
        path.string());
  }
  const Format* format = FormatOf(located);
  if (format == nullptr && kPictures.is(located)) {
    if (!fs::is_directory(located, error) && IsRecordingFolder(folder)) {
      throw DataError("{}: a picture in the folder of a recording, expected the folder, {}", path.string(),
                      folder.string());
    }
    format = &kPictures;
  }
  if (format != nullptr) {
    std::unique_ptr<RecordingSource> recording = WithLevels(format->open(located));
    if (located == path) return recording;
    return std::make_unique<FoundRecording>(std::move(recording), located);
  }
  std::string understood;
  for (const Format& known : kFormats) understood += std::string(known.description) + "; ";
  throw DataError("{}: not a recording of a known format, expected one of: {}{}", path.string(), understood,
                  kPictures.description);
}

}  // namespace sonarcal::data_io
