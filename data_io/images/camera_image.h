// A camera's pictures: which files of a folder they are, when they were taken, and their grey values.
//
// PNG, grey TIFF of 8 bits and JPEG, told by their first bytes. Colour becomes grey as 0.299 R + 0.587 G +
// 0.114 B, 16 bits are cut to 8, an orientation noted by the camera is not applied: pixels stay as the
// calibration saw them. A JPEG's announced size is checked before it is decoded; of one
// that is damaged within, what the decoder makes is taken, with its warning on stderr.
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

// Throws DataError naming the file where it is absent, damaged, cut short or of another kind.
Grid<std::uint8_t> ReadCameraImage(const std::filesystem::path& file);

// How times are told by file names.
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
  std::vector<CameraImageFile> images;  // by time where names tell it, else by name, numbers in it as numbers
  NameTimes times = NameTimes::kNone;
};

// The .png, .jpg, .jpeg, .tif and .tiff files of a folder, at least one. Names tell times where all of them
// are plain numbers ("1700000000.25.png", "1700000000250000.jpg") of one kind: with a decimal point, or 10
// digits: seconds; 13: milliseconds; 16: microseconds; 19: nanoseconds (since 1970, or any other start).
// `unit` takes them for that whatever their digits, kNone for no times. Throws DataError where the folder has
// none, names are not what `unit` asks for, or two have one time.
CameraImageFolder ListCameraImages(const std::filesystem::path& folder, std::optional<NameTimes> unit = {});

}  // namespace sonarcal::data_io
