#include "data_io/sonars/neusis_io.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "core/types/units.h"
#include "data_io/files/file_bytes.h"
#include "data_io/files/folder_path.h"
#include "data_io/files/natural_order.h"
#include "data_io/files/pickle.h"
#include "data_io/json/json_reader.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr const char* kConfig = "Config.json";
constexpr const char* kDataFolder = "Data";
constexpr const char* kImage = "ImagingSonar";
constexpr const char* kPose = "PoseSensor";
constexpr std::size_t kMaxPickleBytes = std::size_t{256} << 20;
constexpr std::size_t kMaxImageSide = 1 << 14;
constexpr double kMaxRangeM = 10'000.0;
constexpr double kFloatLevels = 65535.0;  // grey levels of floating-point images

struct Files {
  fs::path config;
  std::vector<fs::path> pickles;
};

bool IsFile(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

// Config.json beside the pickles, or beside their folder Data.
fs::path ConfigOf(const fs::path& folder) {
  if (IsFile(folder / kConfig)) return folder / kConfig;
  const fs::path whole = PlainFolder(folder);
  if (whole.filename() == kDataFolder && IsFile(whole.parent_path() / kConfig))
    return whole.parent_path() / kConfig;
  return {};
}

std::vector<fs::path> PicklesIn(const fs::path& folder) {
  std::vector<fs::path> pickles;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".pkl" && IsFile(entry.path())) pickles.push_back(entry.path());
  }
  std::ranges::sort(pickles, [](const fs::path& a, const fs::path& b) {
    return NaturalLess(a.filename().string(), b.filename().string());
  });
  return pickles;
}

// Nothing if the path is none of these recordings.
std::optional<Files> FilesOf(const fs::path& path) {
  std::error_code error;
  Files files;
  if (fs::is_directory(path, error)) {
    files.config = ConfigOf(path);
    if (files.config.empty()) return std::nullopt;
    files.pickles = PicklesIn(path);
    if (files.pickles.empty()) files.pickles = PicklesIn(path / kDataFolder);
  } else if (path.extension() == ".pkl" && IsFile(path)) {
    files = {ConfigOf(path.parent_path()), {path}};
  }
  if (files.config.empty() || files.pickles.empty()) return std::nullopt;
  return files;
}

// Place of a sensor on the vehicle, as text for comparison.
std::string MountOf(const JsonReader& sensor) {
  std::string text;
  if (const auto socket = sensor.Find("socket")) text = socket->String();
  for (const char* key : {"location", "rotation"}) {
    if (const auto values = sensor.Find(key)) {
      text += fmt::format(" {}", key);
      for (const double value : values->Numbers()) text += fmt::format(" {:g}", value);
    }
  }
  return text;
}

struct Config {
  double range_min_m = 0.0;
  double range_max_m = 0.0;
  double field_of_view_rad = 0.0;
  double elevation_deg = 0.0;
  std::optional<std::int64_t> range_bins;
  std::optional<std::int64_t> azimuth_bins;
  std::string sonar_name = kImage;
  std::string world;  // of the simulator; empty: none
  bool mounted_apart = false;
};

void ReadSonar(const JsonReader& json, Config& config) {
  config.range_min_m = json.At("RangeMin").Number(NumberRange::Between(0.0, kMaxRangeM));
  config.range_max_m = json.At("RangeMax").Number(NumberRange::AboveUpTo(0.0, kMaxRangeM));
  config.field_of_view_rad = RadFromDeg(json.At("Azimuth").Number(NumberRange::AboveUpTo(0.0, 360.0)));
  json.Update("Elevation", config.elevation_deg, NumberRange::Between(0.0, 360.0));
  if (const auto bins = json.Find("RangeBins")) config.range_bins = bins->Integer(0, kMaxImageSide);
  if (const auto bins = json.Find("AzimuthBins")) config.azimuth_bins = bins->Integer(0, kMaxImageSide);
}

Config ReadConfig(const fs::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  Config config;
  const auto agents = json.Find("agents");
  if (!agents) {
    ReadSonar(json, config);
    return config;
  }
  if (const auto world = json.Find("world")) config.world = world->String();
  for (const JsonReader& agent : agents->Items()) {
    std::optional<JsonReader> sonar;
    std::optional<JsonReader> pose;
    for (const JsonReader& sensor : agent.At("sensors").Items()) {
      const std::string type = sensor.At("sensor_type").String();
      if (type == kImage && !sonar) sonar = sensor;
      if (type == kPose && !pose) pose = sensor;
    }
    if (!sonar) continue;
    ReadSonar(sonar->At("configuration"), config);
    if (const auto name = sonar->Find("sensor_name")) config.sonar_name = Printable(name->String());
    config.mounted_apart = pose && MountOf(*pose) != MountOf(*sonar);
    return config;
  }
  json.Fail("has no sensor of type ImagingSonar, expected one");
}

// Sonar axes of this project, X right, Y ahead, Z up, in those of the pickles, X ahead, Y left, Z up.
Eigen::Matrix3d NeusisFromSonar() {
  Eigen::Matrix3d axes;
  axes.col(0) = -Eigen::Vector3d::UnitY();
  axes.col(1) = Eigen::Vector3d::UnitX();
  axes.col(2) = Eigen::Vector3d::UnitZ();
  return axes;
}

std::optional<Pose> PoseOf(const PickledDict& dict, const std::string& file) {
  constexpr double kRotationError = 1e-3;  // of float32, with room for rounded decimals
  const auto found = dict.arrays.find(kPose);
  if (found == dict.arrays.end()) return std::nullopt;
  const NumpyArray& array = found->second;
  if (array.kind != NumpyArray::Kind::kFloat || array.shape != std::vector<std::size_t>{4, 4}) {
    throw DataError("{}: {} is {} {}, expected 4 x 4 floating-point numbers", file, kPose, array.ShapeText(),
                    array.TypeName());
  }
  Eigen::Matrix4d pose;
  for (int row = 0; row < 4; ++row) {
    for (int col = 0; col < 4; ++col) pose(row, col) = array.At(row, col);
  }
  const Eigen::Matrix3d rotation = pose.topLeftCorner<3, 3>();
  const bool is_pose =
      pose.allFinite() && pose.row(3).isApprox(Eigen::RowVector4d::UnitW(), kRotationError) &&
      (rotation.transpose() * rotation).isIdentity(kRotationError) && rotation.determinant() > 0.0;
  if (!is_pose) throw DataError("{}: {} is not a rotation and a translation", file, kPose);
  return Pose{Eigen::Quaterniond(rotation * NeusisFromSonar()).normalized(), pose.topRightCorner<3, 1>()};
}

const NumpyArray& ImageArrayOf(const PickledDict& dict, const std::string& file) {
  const auto found = dict.arrays.find(kImage);
  if (found == dict.arrays.end()) {
    std::string keys;
    for (std::size_t i = 0; i < std::min<std::size_t>(dict.keys.size(), 10); ++i)
      keys += (i == 0 ? "" : ", ") + Printable(dict.keys[i], 40);
    throw DataError("{}: no array '{}', expected one; the dict has {}", file, kImage,
                    keys.empty() ? "no key" : keys);
  }
  const NumpyArray& array = found->second;
  const bool is_grey = array.kind == NumpyArray::Kind::kUnsigned && array.item_bytes <= 2;
  if (!is_grey && array.kind != NumpyArray::Kind::kFloat) {
    throw DataError("{}: {} is of type {}, expected uint8, uint16, float32 or float64", file, kImage,
                    array.TypeName());
  }
  if (array.shape.size() != 2 || std::ranges::any_of(array.shape, [](std::size_t length) {
        return length < 2 || length > kMaxImageSide;
      })) {
    throw DataError("{}: {} is {}, expected ranges x beams, 2 to {} of each", file, kImage, array.ShapeText(),
                    kMaxImageSide);
  }
  return array;
}

struct Picture {
  Grid<float> value;
  double full_scale = 255.0;
  std::size_t cut_off = 0;  // number of samples above the full scale
};

Picture PictureOf(const NumpyArray& array, const std::string& file) {
  const int rows = static_cast<int>(array.shape[0]);
  const int cols = static_cast<int>(array.shape[1]);
  const bool is_float = array.kind == NumpyArray::Kind::kFloat;
  Picture picture{Grid<float>(rows, cols), is_float || array.item_bytes == 2 ? kFloatLevels : 255.0};
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      double value = array.At(row, cols - 1 - col);
      if (is_float) {
        if (!(value >= 0.0 && std::isfinite(value)))
          throw DataError("{}: {} has the value {}, expected 0 or more", file, kImage, value);
        if (value > 1.0) ++picture.cut_off;
        value = std::round(std::min(value, 1.0) * kFloatLevels);
      }
      picture.value(row, col) = static_cast<float>(value);
    }
  }
  return picture;
}

class NeusisRecording final : public RecordingSource {
 public:
  NeusisRecording(const fs::path& path, Files files) : files_(std::move(files)) {
    config_ = ReadConfig(files_.config);
    const PickledDict first = ReadDict(0);
    const std::string file = files_.pickles[0].string();
    const NumpyArray& array = ImageArrayOf(first, file);
    const Picture picture = PictureOf(array, file);
    info_.source = path.string();
    info_.format = "NeuSIS pickles";
    info_.sonar.name = config_.sonar_name;
    info_.sonar.axes = AxesOf(picture);
    info_.sonar.elevation_beam_width_deg = config_.elevation_deg;
    info_.scale.full_scale = picture.full_scale;
    info_.synthetic = !config_.world.empty();
    if (info_.synthetic)
      info_.details.emplace_back("simulation", "HoloOcean, world " + Printable(config_.world));
    info_.details.emplace_back("samples", array.TypeName());
    NoteConfig(array, picture, PoseOf(first, files_.pickles[0].string()).has_value());
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(files_.pickles.size()); }

  FrameInfo frame_info(int index) const override { return InfoOf(index, ReadDict(index)); }

  Frame ReadFrame(int index) const override {
    const std::string file = files_.pickles.at(index).string();
    const PickledDict dict = ReadDict(index);
    Picture picture = PictureOf(ImageArrayOf(dict, file), file);
    ImageScale scale = info_.scale;
    scale.full_scale = picture.full_scale;
    return {InfoOf(index, dict), {AxesOf(picture), scale, std::move(picture.value)}};
  }

 private:
  PickledDict ReadDict(int index) const {
    const fs::path& file = files_.pickles.at(index);
    return ReadPickledArrays(ReadFileBytes(file, kMaxPickleBytes), file.string());
  }

  FrameInfo InfoOf(int index, const PickledDict& dict) const {
    const fs::path& file = files_.pickles.at(index);
    return {file.filename().string(), std::nullopt, PoseOf(dict, file.string())};
  }

  PolarAxes AxesOf(const Picture& picture) const {
    PolarAxes axes;
    axes.range_min_m = config_.range_min_m;
    axes.range_max_m = config_.range_max_m;
    axes.range_bins = picture.value.rows();
    const int beams = picture.value.cols();
    for (int beam = 0; beam < beams; ++beam)
      axes.beam_azimuth_rad.push_back(config_.field_of_view_rad * ((beam + 0.5) / beams - 0.5));
    axes.Validate(files_.config.string());
    return axes;
  }

  void NoteConfig(const NumpyArray& array, const Picture& picture, bool has_pose) {
    const auto rows = static_cast<std::int64_t>(array.shape[0]);
    const auto cols = static_cast<std::int64_t>(array.shape[1]);
    const std::int64_t stated_rows = config_.range_bins.value_or(rows);
    const std::int64_t stated_cols = config_.azimuth_bins.value_or(cols);
    if (stated_rows != rows || stated_cols != cols) {
      info_.notes.push_back(fmt::format(
          "Config.json states {} x {} bins, but the first image has {}: window and beams are divided by it.",
          stated_rows, stated_cols, array.ShapeText()));
    }
    if (picture.cut_off > 0) {
      info_.notes.push_back(fmt::format("{} of {} samples of the first image are above 1 and were cut off.",
                                        picture.cut_off, picture.value.size()));
    }
    if (!has_pose) info_.notes.emplace_back("The first frame has no PoseSensor.");
    if (has_pose && config_.mounted_apart) {
      info_.notes.emplace_back(
          "Config.json mounts PoseSensor and ImagingSonar differently: the pose is taken as the sonar's.");
    }
    if (!info_.synthetic)
      info_.notes.emplace_back("Config.json does not say whether a sonar or a simulation made the images.");
    if (config_.elevation_deg > 0.0)
      info_.notes.emplace_back("Elevation is the height of the field of view, not a half-power width.");
    info_.notes.emplace_back("Neither frequency, sound speed, water, gain, dB scale nor time is recorded.");
  }

  Files files_;
  Config config_;
  RecordingInfo info_;
};

}  // namespace

bool IsNeusis(const fs::path& path) {
  return FilesOf(path).has_value();
}

std::unique_ptr<RecordingSource> OpenNeusis(const fs::path& path) {
  std::optional<Files> files = FilesOf(path);
  if (!files) {
    throw DataError(
        "{}: expected a folder with Config.json and pickles (.pkl, or Data/*.pkl), or one of them",
        path.string());
  }
  return std::make_unique<NeusisRecording>(path, std::move(*files));
}

}  // namespace sonarcal::data_io
