#include "data_io/camera_image.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "data_io/file_bytes.h"
#include "data_io/image_header.h"
#include "data_io/image_io.h"
#include "data_io/types/error.h"

namespace sonarcal {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = std::size_t{1} << 29;

// The frame header of a JPEG (marker SOFn): its announced size.
ImageHeader JpegHeader(std::string_view bytes, const std::string& name) {
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
  const auto big16 = [&](std::size_t at) { return byte(at) * 256 + byte(at + 1); };
  std::size_t at = 2;
  while (at + 9 < bytes.size() && byte(at) == 0xFF) {
    const int marker = byte(at + 1);
    if (marker == 0xFF) {  // padding
      ++at;
      continue;
    }
    const bool is_frame =
        marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame) {
      return {.rows = big16(at + 5), .cols = big16(at + 7), .channels = byte(at + 9), .bits = byte(at + 4)};
    }
    at += 2 + static_cast<std::size_t>(big16(at + 2));
  }
  throw DataError("{}: damaged JPEG: no frame header, expected a picture", name);
}

Grid<std::uint8_t> DecodeJpeg(const std::string& bytes, const std::string& name) {
  const ImageHeader header = JpegHeader(bytes, name);
  // No CheckImageHeader: a JPEG of one colour is smaller than what that takes for possible.
  if (header.pixels() <= 0 || header.pixels() > kMaxImagePixels) {
    throw DataError("{}: a JPEG of {} x {} pixels, expected 1 to {} pixels", name, header.rows, header.cols,
                    kMaxImagePixels);
  }
  // The decoder fills up what is missing without a word; a whole file ends with the end marker, at most
  // padded.
  const std::size_t end = bytes.rfind("\xFF\xD9");
  if (end == std::string::npos) throw DataError("{}: JPEG cut short, expected an end marker", name);
  cv::Mat image;
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
    image = cv::imdecode(encoded, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& error) {
    throw DataError("{}: damaged JPEG: {}", name, error.err);
  }
  if (image.rows != header.rows || image.cols != header.cols || image.type() != CV_8UC1)
    throw DataError("{}: damaged JPEG, expected {} x {} pixels", name, header.rows, header.cols);
  Grid<std::uint8_t> grey(image.rows, image.cols);
  for (int row = 0; row < image.rows; ++row)
    std::copy_n(image.ptr<std::uint8_t>(row), image.cols, grey.row(row).begin());
  return grey;
}

Grid<std::uint8_t> GreyOf(const RgbImage& rgb) {
  Grid<std::uint8_t> grey(rgb.rows(), rgb.cols());
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    const auto& [r, g, b] = rgb.values()[i];
    grey.values()[i] = static_cast<std::uint8_t>(std::lround(0.299 * r + 0.587 * g + 0.114 * b));
  }
  return grey;
}

bool IsPicture(const fs::path& file) {
  std::string end = file.extension().string();
  std::ranges::transform(end, end.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::string_view, 5> kEnds = {".png", ".jpg", ".jpeg", ".tif", ".tiff"};
  return std::ranges::count(kEnds, end) > 0;
}

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
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
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error != std::errc() || end != name.data() + name.size() || !std::isfinite(number))
    throw DataError("{}: the name is not a number in range, expected a time", file.string());
  const double per_second = unit == NameTimes::kSeconds        ? 1.0
                            : unit == NameTimes::kMilliseconds ? 1e3
                            : unit == NameTimes::kMicroseconds ? 1e6
                                                               : 1e9;
  return number / per_second;
}

// "frame_2" before "frame_10".
bool NaturalLess(const std::string& a, const std::string& b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (!IsDigit(a[i]) || !IsDigit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
      continue;
    }
    const auto digits = [](const std::string& text, std::size_t& at) {
      while (at < text.size() && text[at] == '0') ++at;
      const std::size_t start = at;
      while (at < text.size() && IsDigit(text[at])) ++at;
      return text.substr(start, at - start);
    };
    const std::string x = digits(a, i);
    const std::string y = digits(b, j);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;
}

}  // namespace

Grid<std::uint8_t> ReadCameraImage(const fs::path& file) {
  std::string bytes = ReadFileBytes(file, kMostBytes);
  if (bytes.starts_with("\xFF\xD8")) return DecodeJpeg(bytes, file.string());
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

std::string_view ToString(NameTimes times) {
  switch (times) {
    case NameTimes::kSeconds:
      return "seconds";
    case NameTimes::kMilliseconds:
      return "milliseconds";
    case NameTimes::kMicroseconds:
      return "microseconds";
    case NameTimes::kNanoseconds:
      return "nanoseconds";
    case NameTimes::kNone:
      break;
  }
  return "none";
}

}  // namespace sonarcal
