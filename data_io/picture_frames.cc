#include "data_io/picture_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "data_io/file_bytes.h"
#include "data_io/image_header.h"
#include "data_io/image_io.h"
#include "data_io/types/error.h"

namespace sonarcal {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostPictureBytes = std::size_t{256} << 20;

std::string FirstBytes(const fs::path& file) {
  std::array<char, 16> bytes{};
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return {};
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), bytes.size());
  return {bytes.data(), static_cast<std::size_t>(stream.gcount())};
}

bool IsPng(std::string_view bytes) {
  return bytes.starts_with("\x89PNG\r\n\x1a\n");
}

bool IsJpeg(std::string_view bytes) {
  return bytes.starts_with("\xff\xd8\xff");
}

// Rows and columns of a JPEG, from its start-of-frame segment: known before a decoder allocates anything.
void CheckJpegSize(std::string_view bytes, const std::string& file) {
  const auto byte = [&](std::size_t at) {
    return static_cast<unsigned>(static_cast<unsigned char>(bytes[at]));
  };
  std::size_t at = 2;
  while (at + 9 <= bytes.size() && byte(at) == 0xff) {
    const unsigned marker = byte(at + 1);
    if (marker == 0xff) {  // padding
      ++at;
      continue;
    }
    const bool is_frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (is_frame) {
      const ImageHeader header{.rows = static_cast<int>(byte(at + 5) << 8 | byte(at + 6)),
                               .cols = static_cast<int>(byte(at + 7) << 8 | byte(at + 8)),
                               .channels = 1,
                               .bits = 8};
      if (header.pixels() <= 0 || header.pixels() > kMaxImagePixels) {
        throw DataError("{}: a JPEG of {} x {} pixels, expected 1..{} in all", file, header.rows, header.cols,
                        kMaxImagePixels);
      }
      return;
    }
    at += 2 + (byte(at + 2) << 8 | byte(at + 3));
  }
  throw DataError("{}: byte {}: a JPEG without a frame", file, at);
}

// Luminance as in ITU-R BT.601; of equal channels their value.
Grid<float> GreyOf(const cv::Mat& picture, const std::string& name) {
  if (picture.empty() || picture.type() != CV_8UC3)
    throw DataError("{}: not to be decoded as a picture of 8 bits", name);
  Grid<float> grey(picture.rows, picture.cols);
  for (int row = 0; row < picture.rows; ++row) {
    const auto* pixels = picture.ptr<cv::Vec3b>(row);
    for (int col = 0; col < picture.cols; ++col) {
      const cv::Vec3b& p = pixels[col];
      const bool equal = p[0] == p[1] && p[1] == p[2];
      grey(row, col) = equal ? static_cast<float>(p[0])
                             : 0.114F * static_cast<float>(p[0]) + 0.587F * static_cast<float>(p[1]) +
                                   0.299F * static_cast<float>(p[2]);
    }
  }
  return grey;
}

Grid<float> GreyOf(const RgbImage& picture) {
  Grid<float> grey(picture.rows(), picture.cols());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const auto [red, green, blue] = picture.values()[i];
    grey.values()[i] = red == green && green == blue
                           ? static_cast<float>(red)
                           : 0.299F * static_cast<float>(red) + 0.587F * static_cast<float>(green) +
                                 0.114F * static_cast<float>(blue);
  }
  return grey;
}

class PictureFiles final : public PictureFrames {
 public:
  explicit PictureFiles(std::vector<fs::path> files) : files_(std::move(files)) {
    for (const fs::path& file : files_) is_lossy_ = is_lossy_ || IsJpeg(FirstBytes(file));
  }

  int count() const override { return static_cast<int>(files_.size()); }
  std::string name(int index) const override { return files_.at(index).filename().string(); }
  bool is_lossy() const override { return is_lossy_; }

  Grid<float> Read(int index) const override {
    const fs::path& file = files_.at(index);
    std::string bytes = ReadFileBytes(file, kMostPictureBytes);
    if (!IsJpeg(bytes)) return GreyOf(ImageFile(std::move(bytes), file.string()).DecodeRgb());
    CheckJpegSize(bytes, file.string());
    cv::Mat picture;
    try {
      const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data());
      picture = cv::imdecode(encoded, cv::IMREAD_COLOR);
    } catch (const cv::Exception&) {
      picture.release();
    }
    return GreyOf(picture, file.string());
  }

 private:
  std::vector<fs::path> files_;
  bool is_lossy_ = false;
};

class Video final : public PictureFrames {
 public:
  explicit Video(const fs::path& file) : name_(file.string()) {
    try {
      capture_.open(name_);
    } catch (const cv::Exception&) {
      capture_.release();
    }
    if (!capture_.isOpened()) throw DataError("{}: a video that cannot be decoded", name_);
    const double frames = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    const double pixels = capture_.get(cv::CAP_PROP_FRAME_WIDTH) * capture_.get(cv::CAP_PROP_FRAME_HEIGHT);
    constexpr double kMostFrames = 1e8;
    if (!(frames >= 1.0 && frames <= kMostFrames))
      throw DataError("{}: the video announces {} frames, expected 1..{}", name_, frames, kMostFrames);
    if (!(pixels >= 1.0 && pixels <= static_cast<double>(kMaxImagePixels)))
      throw DataError("{}: the video announces {} pixels, expected 1..{}", name_, pixels, kMaxImagePixels);
    count_ = static_cast<int>(frames);
    frame_rate_hz_ = capture_.get(cv::CAP_PROP_FPS);
  }

  int count() const override { return count_; }
  std::string name(int index) const override { return fmt::format("frame {}", index); }
  bool is_lossy() const override { return true; }

  std::optional<double> time_s(int index) const override {
    if (!(frame_rate_hz_ > 0.0 && std::isfinite(frame_rate_hz_))) return std::nullopt;
    return index / frame_rate_hz_;
  }

  // One frame after the other needs no search; any other is looked for.
  Grid<float> Read(int index) const override {
    const std::scoped_lock lock(mutex_);
    cv::Mat picture;
    try {
      if (index != next_) capture_.set(cv::CAP_PROP_POS_FRAMES, index);
      if (!capture_.read(picture)) picture.release();
    } catch (const cv::Exception&) {
      picture.release();
    }
    next_ = index + 1;
    if (picture.empty()) throw DataError("{}: frame {} of {} cannot be decoded", name_, index, count_);
    return GreyOf(picture, name_);
  }

 private:
  std::string name_;
  int count_ = 0;
  double frame_rate_hz_ = 0.0;
  mutable std::mutex mutex_;
  mutable cv::VideoCapture capture_;
  mutable int next_ = 0;
};

}  // namespace

bool IsPicture(const fs::path& file) {
  const std::string bytes = FirstBytes(file);
  return IsPng(bytes) || IsJpeg(bytes);
}

bool IsVideo(const fs::path& file) {
  const std::string bytes = FirstBytes(file);
  const std::string_view view = bytes;
  return (view.starts_with("RIFF") && view.size() >= 12 && view.substr(8, 4) == "AVI ") ||
         (view.size() >= 8 && view.substr(4, 4) == "ftyp") ||  // MP4, MOV
         view.starts_with("\x1a\x45\xdf\xa3");                 // Matroska, WebM
}

std::vector<fs::path> PicturesOf(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (IsPicture(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::unique_ptr<PictureFrames> OpenPictures(const fs::path& path) {
  if (IsVideo(path)) return std::make_unique<Video>(path);
  std::vector<fs::path> files = IsPicture(path) ? std::vector<fs::path>{path} : PicturesOf(path);
  if (files.empty()) throw DataError("{}: no picture (PNG, JPEG) or video", path.string());
  return std::make_unique<PictureFiles>(std::move(files));
}

}  // namespace sonarcal
