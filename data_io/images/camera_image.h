// Pictures of a camera: the files of a folder, their times, and their grey values.
//
// Reads PNG, grey TIFF of 8 bits and JPEG, detected by their first bytes. Colour is converted to grey as
// 0.299 R + 0.587 G + 0.114 B, and 16 bits are truncated to 8. The orientation tag of the camera is ignored,
// so pixels match the calibration. The announced size of a JPEG is checked before decoding. A JPEG with
// damaged content is used as the decoder returns it, with its warning on stderr.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/types/image.h"
#include "core/types/words.h"

namespace sonarcal::data_io {

// Throws DataError, naming the file, if it is absent, damaged, truncated or of another type.
Grid<std::uint8_t> ReadCameraImage(const std::filesystem::path& file);

// Unit of the times in file names.
enum class NameTimes { kNone, kSeconds, kMilliseconds, kMicroseconds, kNanoseconds };
constexpr auto WordsOf(std::type_identity<NameTimes>) {
  return Words<NameTimes, 5>{{{"none", NameTimes::kNone},
                              {"seconds", NameTimes::kSeconds},
                              {"milliseconds", NameTimes::kMilliseconds},
                              {"microseconds", NameTimes::kMicroseconds},
                              {"nanoseconds", NameTimes::kNanoseconds}}};
}

struct CameraImageFile {
  std::filesystem::path file;
  std::optional<double> time_s;  // from its name
};

struct CameraImageFolder {
  std::vector<CameraImageFile> images;  // by time if names contain it, otherwise by name in natural order
  NameTimes times = NameTimes::kNone;
};

// The .png, .jpg, .jpeg, .tif and .tiff files of a folder, at least one. Names contain times if all of them
// are plain numbers ("1700000000.25.png", "1700000000250000.jpg") of one kind: with a decimal point or 10
// digits: seconds; 13: milliseconds; 16: microseconds; 19: nanoseconds (since 1970, or any other start).
// `unit` sets the kind regardless of the digits; kNone means no times. Throws DataError if the folder has no
// such file, names do not match `unit`, or two have the same time.
CameraImageFolder ListCameraImages(const std::filesystem::path& folder, std::optional<NameTimes> unit = {});

}  // namespace sonarcal::data_io
