#include "data_io/pictures/picture_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/videoio.hpp>

#include "core/types/error.h"
#include "data_io/files/file_bytes.h"
#include "data_io/files/natural_order.h"
#include "data_io/images/image_header.h"
#include "data_io/images/image_io.h"
#include "data_io/images/jpeg_codec.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxPictureBytes = std::size_t{256} << 20;

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

Grid<float> Floats(const Grid<std::uint8_t>& grey) {
  Grid<float> values(grey.rows(), grey.cols());
  std::ranges::copy(grey.values(), values.values().begin());
  return values;
}

// Converts from OpenCV's channel order, blue first.
RgbImage RgbOf(const cv::Mat& picture) {
  RgbImage rgb(picture.rows, picture.cols);
  for (int row = 0; row < picture.rows; ++row) {
    const auto* pixels = picture.ptr<cv::Vec3b>(row);
    for (int col = 0; col < picture.cols; ++col) {
      const cv::Vec3b& pixel = pixels[col];
      rgb(row, col) = {pixel[2], pixel[1], pixel[0]};
    }
  }
  return rgb;
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
    std::string bytes = ReadFileBytes(file, kMaxPictureBytes);
    if (IsJpeg(bytes)) return Floats(DecodeJpegGrey(bytes, file.string()));
    const ImageFile picture(std::move(bytes), file.string());
    const ImageHeader& header = picture.header();
    if (header.channels != 1 || header.bits != 16) return Floats(GreyOf(picture.DecodeRgb()));
    Grid<float> grey = picture.DecodeGrey();
    for (float& value : grey.values()) value /= 257.0F;  // 65535 is 255
    return grey;
  }

  RgbImage ReadColors(int index) const override {
    const fs::path& file = files_.at(index);
    std::string bytes = ReadFileBytes(file, kMaxPictureBytes);
    if (IsJpeg(bytes)) return DecodeJpegRgb(bytes, file.string());
    return ImageFile(std::move(bytes), file.string()).DecodeRgb();
  }

 private:
  std::vector<fs::path> files_;
  bool is_lossy_ = false;
};

// Four letters of the codec in the header of an AVI file; empty if there are none.
std::string CodecOfAvi(const fs::path& file) {
  constexpr std::size_t kMaxHeaderBytes = 4096;
  constexpr std::size_t kCodecOffset = 24;  // behind "strf", its size and 16 bytes of BITMAPINFOHEADER
  std::string bytes(kMaxHeaderBytes, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), kMaxHeaderBytes);
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  const std::size_t format = bytes.find("strf");
  if (!bytes.starts_with("RIFF") || format == std::string::npos || format + kCodecOffset + 4 > bytes.size())
    return {};
  const std::string codec = bytes.substr(format + kCodecOffset, 4);
  const auto is_printable = [](char letter) { return letter > ' ' && letter <= '~'; };
  return std::ranges::all_of(codec, is_printable) ? codec : std::string();
}

class Video final : public PictureFrames {
 public:
  explicit Video(const fs::path& file) : name_(file.string()) {
    try {
      // FFmpeg only: OpenCV would otherwise try other backends, including cameras.
      capture_.open(name_, cv::CAP_FFMPEG);
    } catch (const cv::Exception&) {
      capture_.release();
    }
    if (!capture_.isOpened()) {
      const std::string codec = CodecOfAvi(file);
      throw DataError("{}: a video that OpenCV and FFmpeg on this machine cannot decode{}", name_,
                      codec.empty() ? "" : " (codec " + codec + ")");
    }
    const double frames = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    const double pixels = capture_.get(cv::CAP_PROP_FRAME_WIDTH) * capture_.get(cv::CAP_PROP_FRAME_HEIGHT);
    constexpr double kMaxFrames = 1e8;
    if (!(frames >= 1.0 && frames <= kMaxFrames))
      throw DataError("{}: the video announces {} frames, expected 1..{}", name_, frames, kMaxFrames);
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

  Grid<float> Read(int index) const override { return Floats(GreyOf(ReadColors(index))); }

  // Sequential frames need no seek.
  RgbImage ReadColors(int index) const override {
    const std::scoped_lock lock(mutex_);
    cv::Mat picture;
    try {
      if (index != next_) capture_.set(cv::CAP_PROP_POS_FRAMES, index);
      if (!capture_.read(picture)) picture.release();
    } catch (const cv::Exception&) {
      picture.release();
    }
    next_ = index + 1;
    if (picture.empty() || picture.type() != CV_8UC3)
      throw DataError("{}: frame {} of {} cannot be decoded", name_, index, count_);
    return RgbOf(picture);
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
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) {
    return NaturalLess(a.filename().string(), b.filename().string());
  });
  return files;
}

std::unique_ptr<PictureFrames> OpenPictures(const fs::path& path) {
  if (IsVideo(path)) return std::make_unique<Video>(path);
  std::vector<fs::path> files = IsPicture(path) ? std::vector<fs::path>{path} : PicturesOf(path);
  if (files.empty()) throw DataError("{}: no picture (PNG, JPEG) or video", path.string());
  return std::make_unique<PictureFiles>(std::move(files));
}

}  // namespace sonarcal::data_io
