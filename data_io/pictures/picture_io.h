// Opens pictures and videos exported by sonar viewers (PNG, JPEG, AVI, MP4): a picture, a folder of pictures,
// or a video, converted to range and azimuth. Missing properties come from a JSON file beside it
// (data_io/pictures/picture_geometry.h): `NAME.geometry.json` beside a file NAME, `geometry.json` in a
// folder. A fan without a given position is found by its edges, in up to 32 frames.
//
// Notes state the limits: grey values contain the viewer's processing, neighbouring samples of a fan are not
// independent, and colour pictures are reduced to their luminance. Samples outside the picture are 0; their
// fraction is noted.
#pragma once

#include <filesystem>
#include <memory>

#include "core/types/recording.h"
#include "data_io/pictures/picture_geometry.h"

namespace sonarcal::data_io {

// True for a picture, a folder of pictures or a video. Reads only the first bytes.
bool IsPictures(const std::filesystem::path& path);

// True for pictures with that JSON file beside them.
bool HasPictureGeometry(const std::filesystem::path& path);

// Throws DataError if the JSON file is absent (the message contains a template with the fan that was found),
// if no fan is found, or if a picture cannot be read.
std::unique_ptr<RecordingSource> OpenPictureRecording(const std::filesystem::path& path);

// As above with a given geometry; does not look for a file beside the picture.
std::unique_ptr<RecordingSource> OpenPictureRecording(const std::filesystem::path& path,
                                                      const PictureGeometry& geometry);

}  // namespace sonarcal::data_io
