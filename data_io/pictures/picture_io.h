// Pictures and videos as sonar viewers export them (PNG, JPEG, AVI, MP4): a picture, a folder of them, or a
// video, brought to range and azimuth. What a picture does not say stands in a JSON file beside it
// (data_io/pictures/picture_geometry.h): `NAME.geometry.json` beside a file NAME, `geometry.json` in a
// folder. A fan whose place is not given is found by its edges, over up to 32 of the frames.
//
// Grey values have passed through whatever the viewer did to them, neighbouring samples of a fan are not
// independent, and of a colour picture the luminance is taken: notes say so. What lies outside the picture is
// 0, and the share of it is noted.
#pragma once

#include <filesystem>
#include <memory>

#include "core/types/recording.h"
#include "data_io/pictures/picture_geometry.h"

namespace sonarcal::data_io {

// A picture, a folder of pictures or a video. Reads first bytes only.
bool IsPictures(const std::filesystem::path& path);

// Pictures with that JSON file beside them.
bool HasPictureGeometry(const std::filesystem::path& path);

// Throws DataError where the JSON file is absent (the sentence holds one to begin with, with the fan that was
// found), where no fan can be made out, or a picture is not to be read.
std::unique_ptr<RecordingSource> OpenPictureRecording(const std::filesystem::path& path);

// With a geometry from elsewhere; no file beside the picture is looked for.
std::unique_ptr<RecordingSource> OpenPictureRecording(const std::filesystem::path& path,
                                                      const PictureGeometry& geometry);

}  // namespace sonarcal::data_io
