#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/types/error.h"
#include "data_io/bag_trajectory.h"
#include "data_io/files/hash.h"
#include "data_io/files/pickle.h"
#include "data_io/images/image_io.h"
#include "data_io/images/jpeg_codec.h"
#include "data_io/mcap/mcap_file.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/camera_io.h"
#include "data_io/parameters/marker_map_io.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pictures/fan_geometry.h"
#include "data_io/pictures/fan_search.h"
#include "data_io/pictures/picture_frames.h"
#include "data_io/pose_io.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/scenes/cad_io.h"
#include "data_io/scenes/scene_io.h"
#include "data_io/sonars/frame_tree.h"
#include "data_io/trajectory_io.h"
#include "metrics/json/comparison_part.h"
#include "tests/fuzz/fuzz_target.h"

namespace sonarcal::fuzz {
namespace {

namespace fs = std::filesystem;

// A folder of this process alone, in memory where the system has such a place.
class Folder {
 public:
  Folder() {
    const fs::path root = fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
    path_ = root / ("sonarcal_fuzz_" + std::to_string(getpid()));
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  fs::path Write(const std::string& name, std::string_view bytes) const {
    std::ofstream(path_ / name, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path_ / name;
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

const Folder& TheFolder() {
  static const Folder kFolder;
  return kFolder;
}

// An input may hold frames by the thousand, all through the same code.
void ReadSomeFrames(const RecordingSource& recording) {
  for (int i = 0; i < std::min(recording.frame_count(), 4); ++i) {
    recording.frame_info(i);
    recording.ReadFrame(i);
  }
  if (recording.frame_count() > 4) recording.ReadFrame(recording.frame_count() - 1);
}

void RecordingFile(std::string_view bytes) {
  ReadSomeFrames(*data_io::OpenRecording(TheFolder().Write("recording.bin", bytes)));
}

// The frame beside it: 3 x 2 pixels.
void RecordingFolder(std::string_view bytes) {
  static const bool kWritten = [] {
    data_io::WritePng(TheFolder().path() / "frame_0000.png", Grid<std::uint8_t>(3, 2, 100));
    return true;
  }();
  static_cast<void>(kWritten);
  TheFolder().Write("recording.json", bytes);
  ReadSomeFrames(*data_io::OpenRecordingFolder(TheFolder().path()));
}

// Settings of a DIDSON ping, beside a picture of one.
void DidsonSettings(std::string_view bytes) {
  static const bool kWritten = [] {
    data_io::WritePng(TheFolder().path() / "1468966376476216.png", Grid<std::uint8_t>(512, 96, 7));
    return true;
  }();
  static_cast<void>(kWritten);
  ReadSomeFrames(*data_io::OpenRecording(TheFolder().Write("1468966376476216.json", bytes)));
}

void Picture(std::string_view bytes) {
  const data_io::ImageFile file(std::string(bytes), "picture");
  try {
    file.DecodeGrey();
  } catch (const DataError&) {
    file.DecodeRgb();
  }
}

// A damaged header may announce a picture that takes seconds. Such a picture is not decoded.
void Jpeg(std::string_view bytes) {
  constexpr std::int64_t kMaxPixels = 1 << 16;
  if (data_io::ReadJpegHeader(bytes, "picture").pixels() > kMaxPixels) return;
  data_io::DecodeJpegGrey(bytes, "picture");
  data_io::DecodeJpegRgb(bytes, "picture");
}

// Pictures in memory, black and white.
class MaskPictures : public data_io::PictureFrames {
 public:
  MaskPictures(std::vector<Mask> masks, bool is_lossy) : masks_(std::move(masks)), is_lossy_(is_lossy) {}

  int count() const override { return static_cast<int>(masks_.size()); }
  std::string name(int) const override { return "picture"; }
  Grid<float> Read(int) const override { throw std::logic_error("a search reads colours"); }
  RgbImage ReadColors(int index) const override {
    constexpr std::uint8_t kWhite = 200;
    const Mask& mask = masks_[index];
    RgbImage colors(mask.rows(), mask.cols());
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (mask.values()[i] != 0) colors.values()[i] = {kWhite, kWhite, kWhite};
    }
    return colors;
  }
  bool is_lossy() const override { return is_lossy_; }

 private:
  std::vector<Mask> masks_;
  bool is_lossy_;
};

// Pictures in which a fan is looked for: a byte for the rows, up to 32, a byte for the columns, and the
// pixels, one bit each. A pixel that is missing is black. Bits of the first byte say whether there are four
// pictures, which shows what stays, and whether they were compressed with losses. The files of pictures
// themselves are the inputs of Picture and Jpeg.
void FanPicture(std::string_view bytes) {
  constexpr int kFour = 64;
  constexpr int kLossy = 128;
  if (bytes.size() < 2) throw DataError("{} bytes, expected the size of a picture", bytes.size());
  const auto byte = [&](std::size_t i) {
    return static_cast<unsigned char>(i < bytes.size() ? bytes[i] : 0);
  };
  const int rows = 1 + byte(0) % 32;
  const int cols = 1 + byte(1) % 32;
  std::vector<Mask> masks((byte(0) & kFour) != 0 ? 4 : 1, Mask(rows, cols));
  std::size_t bit = 16;
  for (Mask& mask : masks) {
    for (std::uint8_t& pixel : mask.values()) {
      pixel = byte(bit / 8) >> bit % 8 & 1;
      ++bit;
    }
  }
  const MaskPictures pictures(std::move(masks), (byte(0) & kLossy) != 0);
  const data_io::FanSearch search(pictures);
  if (!search.fan()) throw DataError("no fan in {} x {} pixels", rows, cols);
  for (int index = 0; index < pictures.count(); ++index)
    data_io::ShowsAnotherFan(search.LitPixels(index), *search.fan());
}

// What is said of it, beside a picture of a fan of 60 degrees.
void PictureGeometry(std::string_view bytes) {
  static const fs::path kPicture = [] {
    Grid<std::uint8_t> fan(60, 70);
    for (int row = 0; row < 60; ++row) {
      for (int col = 0; col < 70; ++col) {
        const int right = col - 35;
        const int ahead = 60 - row;
        const bool inside = std::abs(right) * 7 < ahead * 4 && right * right + ahead * ahead < 3000;
        fan(row, col) = inside ? 200 : 0;
      }
    }
    data_io::WritePng(TheFolder().path() / "fan.png", fan);
    return TheFolder().path() / "fan.png";
  }();
  TheFolder().Write("fan.png.geometry.json", bytes);
  ReadSomeFrames(*data_io::OpenRecording(kPicture));
}

// The container alone: every message is read.
void Mcap(std::string_view bytes) {
  constexpr std::uint64_t kMaxMessageBytes = 1 << 24;
  constexpr std::size_t kMaxMessages = 10'000;
  data_io::McapFile file(TheFolder().Write("file.mcap", bytes), "file.mcap", kMaxMessageBytes);
  for (const auto& [channel, messages] : file.TakeMessages()) {
    for (std::size_t i = 0; i < std::min(messages.size(), kMaxMessages); ++i) file.Read(messages[i]);
  }
}

// A frame beside a configuration that fits.
void Neusis(std::string_view bytes) {
  static const fs::path kConfig =
      TheFolder().Write("Config.json", R"({"RangeMin": 0, "RangeMax": 3, "Azimuth": 60, "Elevation": 12})");
  ReadSomeFrames(*data_io::OpenRecording(TheFolder().Write("000.pkl", bytes)));
}

void Pickle(std::string_view bytes) {
  data_io::ReadPickledArrays(std::string(bytes), "file.pkl");
}

void Gltf(std::string_view bytes) {
  data_io::ParseGltf(bytes, TheFolder().Write("scene.gltf", bytes));
}

void Obj(std::string_view bytes) {
  data_io::ParseObj(std::string(bytes), "scene.obj");
}

void Ply(std::string_view bytes) {
  data_io::ParsePly(std::string(bytes), "scene.ply");
}

void Stl(std::string_view bytes) {
  data_io::ParseStl(std::string(bytes), "scene.stl");
}

void Parameters(std::string_view bytes) {
  data_io::ParseParameters(bytes, "params.json");
}

void Poses(std::string_view bytes) {
  data_io::ReadPoses(TheFolder().Write("poses.json", bytes));
}

void Trajectory(std::string_view bytes) {
  const fs::path file = TheFolder().Write("trajectory.txt", bytes);
  data_io::ReadTrajectory(file, data_io::GuessTrajectoryFormat(file));
}

// Poses in a bag, then its transforms.
void BagTrajectory(std::string_view bytes) {
  const fs::path bag = TheFolder().Write("trajectory.bag", bytes);
  try {
    data_io::ReadBagTrajectory(bag, {.topic = "/odom"});
  } catch (const DataError&) {
    data_io::ReadBagTrajectory(bag, {.topic = "/tf", .world_frame = "odom", .body_frame = "base_link"});
  }
}

// Table of the frames of the DFKI data set, beside a picture of one.
void DfkiFrames(std::string_view bytes) {
  static const bool kWritten = [] {
    fs::create_directories(TheFolder().path() / "aris_raw");
    TheFolder().Write("aris_raw/0622.pgm", "P5\n64 6\n255\n" + std::string(std::size_t{64} * 6, 'x'));
    return true;
  }();
  static_cast<void>(kWritten);
  TheFolder().Write("aris_frame_meta.csv", bytes);
  ReadSomeFrames(*data_io::OpenRecording(TheFolder().path()));
}

void FrameTreeFile(std::string_view bytes) {
  data_io::FrameTree(TheFolder().Write("transforms.yaml", bytes)).Find("setup/ar3", "setup/sonar");
}

void MarkerMapFile(std::string_view bytes) {
  data_io::ReadMarkerMap(TheFolder().Write("map.json", bytes));
}

void CameraFile(std::string_view bytes) {
  data_io::CameraFromText(bytes, "camera.yaml");
}

void Mount(std::string_view bytes) {
  data_io::ReadMount(TheFolder().Write("mount.json", bytes));
}

// The input follows the hash of a part of a comparison. The hash is that of the input, so that damage reaches
// the parser.
void ComparisonPartBody(std::string_view bytes) {
  static const std::string kHeader = [] {
    const std::string part = metrics::ComparisonPartBytes({});
    return part.substr(0, part.find('\n') + 1);
  }();
  metrics::ParseComparisonPart(kHeader + data_io::Sha256(bytes) + std::string(bytes), "part");
}

struct NamedParser {
  std::string_view name;
  Parser parser;
};

constexpr NamedParser kParsers[] = {
    {"recording_file", RecordingFile},
    {"recording_folder", RecordingFolder},
    {"didson_settings", DidsonSettings},
    {"picture", Picture},
    {"jpeg", Jpeg},
    {"fan_picture", FanPicture},
    {"picture_geometry", PictureGeometry},
    {"gltf", Gltf},
    {"mcap", Mcap},
    {"neusis", Neusis},
    {"obj", Obj},
    {"pickle", Pickle},
    {"ply", Ply},
    {"stl", Stl},
    {"parameters", Parameters},
    {"poses", Poses},
    {"trajectory", Trajectory},
    {"bag_trajectory", BagTrajectory},
    {"dfki_frames", DfkiFrames},
    {"frame_tree", FrameTreeFile},
    {"mount", Mount},
    {"marker_map", MarkerMapFile},
    {"camera", CameraFile},
    {"comparison_part", ComparisonPartBody},
};

}  // namespace

Parser FindParser(std::string_view name) {
  const auto* const found = std::ranges::find(kParsers, name, &NamedParser::name);
  return found == std::end(kParsers) ? nullptr : found->parser;
}

std::string Feed(Parser parser, std::string_view bytes) {
  try {
    parser(bytes);
  } catch (const DataError& error) {
    if (*error.what() == '\0') std::abort();
    return error.what();
  }
  return {};
}

}  // namespace sonarcal::fuzz
