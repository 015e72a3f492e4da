#include "data_io/images/camera_image.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "core/types/error.h"
#include "core/types/parse_number.h"
#include "data_io/files/file_bytes.h"
#include "data_io/files/natural_order.h"
#include "data_io/images/image_io.h"
#include "data_io/images/jpeg_codec.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxImageBytes = std::size_t{1} << 29;

bool IsPicture(const fs::path& file) {
  std::string end = file.extension().string();
  std::ranges::transform(end, end.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::string_view, 5> kEnds = {".png", ".jpg", ".jpeg", ".tif", ".tiff"};
  return std::ranges::count(kEnds, end) > 0;
}

bool IsPlainNumber(std::string_view name) {
  if (name.empty() || !IsDigit(name.front()) || !IsDigit(name.back())) return false;
  return std::ranges::all_of(name, [](char c) { return IsDigit(c) || c == '.'; }) &&
         std::ranges::count(name, '.') <= 1;
}

NameTimes UnitOf(std::string_view name) {
  if (!IsPlainNumber(name)) return NameTimes::kNone;
  if (name.find('.') != std::string_view::npos) return NameTimes::kSeconds;
  switch (name.size()) {
    case 10:
      return NameTimes::kSeconds;
    case 13:
      return NameTimes::kMilliseconds;
    case 16:
      return NameTimes::kMicroseconds;
    case 19:
      return NameTimes::kNanoseconds;
    default:
      return NameTimes::kNone;
  }
}

double SecondsOf(std::string_view name, NameTimes unit, const fs::path& file) {
  double number = 0.0;
  if (!ParseNumber(name, number) || !std::isfinite(number))
    throw DataError("{}: the name is not a number in range, expected a time", file.string());
  const double per_second = unit == NameTimes::kSeconds        ? 1.0
                            : unit == NameTimes::kMilliseconds ? 1e3
                            : unit == NameTimes::kMicroseconds ? 1e6
                                                               : 1e9;
  return number / per_second;
}

}  // namespace

Grid<std::uint8_t> ReadCameraImage(const fs::path& file) {
  std::string bytes = ReadFileBytes(file, kMaxImageBytes);
  if (IsJpeg(bytes)) return DecodeJpegGrey(bytes, file.string());
  const ImageFile image(std::move(bytes), file.string());
  if (image.header().channels == 1 && image.header().bits == 8) return image.DecodeGrey8();
  return GreyOf(image.DecodeRgb());
}

CameraImageFolder ListCameraImages(const fs::path& folder, std::optional<NameTimes> unit) {
  if (!fs::is_directory(folder))
    throw DataError("{}: no such folder, expected one of images", folder.string());
  CameraImageFolder found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && IsPicture(entry.path())) found.images.push_back({entry.path(), {}});
  }
  if (found.images.empty())
    throw DataError("{}: no .png, .jpg, .jpeg, .tif or .tiff file, expected images", folder.string());
  const auto stem = [](const CameraImageFile& image) { return image.file.stem().string(); };
  std::ranges::sort(found.images, [&](const auto& a, const auto& b) {
    return NaturalLess(a.file.filename().string(), b.file.filename().string());
  });
  found.times = unit ? *unit : UnitOf(stem(found.images.front()));
  if (!unit &&
      !std::ranges::all_of(found.images, [&](const auto& i) { return UnitOf(stem(i)) == found.times; }))
    found.times = NameTimes::kNone;
  if (found.times == NameTimes::kNone) return found;
  for (CameraImageFile& image : found.images) {
    if (!IsPlainNumber(stem(image)))
      throw DataError("{}: the name is not a plain number, expected a time", image.file.string());
    image.time_s = SecondsOf(stem(image), found.times, image.file);
  }
  std::ranges::stable_sort(found.images, {}, [](const auto& image) { return *image.time_s; });
  for (std::size_t i = 1; i < found.images.size(); ++i) {
    if (!(*found.images[i].time_s > *found.images[i - 1].time_s)) {
      throw DataError("{}: the same time as {}, expected different ones", found.images[i].file.string(),
                      found.images[i - 1].file.filename().string());
    }
  }
  return found;
}

}  // namespace sonarcal::data_io
