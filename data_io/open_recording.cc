#include "data_io/open_recording.h"

#include "core/types/error.h"
#include "data_io/pictures/picture_io.h"
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
    // Last, because it accepts any picture, also those of the formats above.
    {"pictures or a video of a viewer (PNG, JPEG, AVI, MP4)", IsPictures, OpenPictureRecording},
};

}  // namespace

std::unique_ptr<RecordingSource> OpenRecording(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw DataError("{}: no such file or folder", path.string());
  std::string understood;
  for (const Format& format : kFormats) {
    if (format.is(path)) return format.open(path);
    understood += understood.empty() ? format.description : std::string("; ") + format.description;
  }
  throw DataError("{}: not a recording of a known format, expected one of: {}", path.string(), understood);
}

}  // namespace sonarcal::data_io
