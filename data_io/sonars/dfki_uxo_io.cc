#include "data_io/sonars/dfki_uxo_io.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "core/types/rotation.h"
#include "data_io/files/csv_table.h"
#include "data_io/files/folder_path.h"
#include "data_io/images/pgm_codec.h"
#include "data_io/sonars/aris_model.h"
#include "data_io/sonars/frame_tree.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMaxFrameIndex = 100'000'000;
constexpr double kMaxM = 1e6;

// Sonar pose in the frame of the data set's calibration, which has X right, Y down, Z forward.
Pose CalibrationFromSonar() {
  Eigen::Matrix3d axes;
  axes.col(0) = Eigen::Vector3d::UnitX();   // right
  axes.col(1) = Eigen::Vector3d::UnitZ();   // forward
  axes.col(2) = -Eigen::Vector3d::UnitY();  // up
  return {Eigen::Quaterniond(axes), Eigen::Vector3d::Zero()};
}

ArisHeader HeaderOf(const CsvTable& table, int row) {
  const auto whole = [&](const char* column, std::int64_t lowest, std::int64_t highest) {
    return static_cast<std::uint32_t>(table.Integer(row, column, lowest, highest));
  };
  const auto number = [&](const char* column, double lowest, double highest) {
    return static_cast<float>(table.Number(row, column, lowest, highest));
  };
  constexpr std::int64_t kMaxU32 = 0xffffffff;
  ArisHeader header;
  header.time_s = table.Number(row, "FrameTime", 0.0, 1e18) * 1e-6;
  header.window_start_m = number("WindowStart", -kMaxM, kMaxM);
  header.window_length_m = number("WindowLength", -kMaxM, kMaxM);
  header.gain_db = whole("ReceiverGain", 0, kMaxU32);
  header.water_temperature_c = number("WaterTemp", -kMaxM, kMaxM);
  header.ping_mode = whole("PingMode", 1, 12);
  header.high_frequency = whole("FrequencyHiLow", 0, kMaxU32) != 0;
  header.pulse_width_us = whole("PulseWidth", 0, kMaxU32);
  header.sample_period_us = whole("SamplePeriod", 1, 1000);
  header.frame_rate_hz = number("FrameRate", 0.0, kMaxM);
  header.sound_speed_m_per_s = number("SoundSpeed", 1300.0, 1700.0);
  header.samples_per_beam = whole("SamplesPerBeam", 1, kMaxArisSamplesPerBeam);
  header.sample_start_delay_us = whole("SampleStartDelay", 0, 1'000'000);
  header.lens = whole("LargeLens", 0, kMaxU32) != 0 ? ArisLens::kTelephoto : ArisLens::kStandard;
  header.system = static_cast<ArisSystem>(whole("TheSystemType", 0, 2));
  header.salinity_ppt = whole("Salinity", 0, kMaxU32);
  return header;
}

std::map<std::int64_t, Pose> ReadArm(const fs::path& file) {
  const CsvTable table(file);
  std::map<std::int64_t, Pose> world_from_arm;
  for (int row = 0; row < table.rows(); ++row) {
    const auto number = [&](const char* column) { return table.Number(row, column, -kMaxM, kMaxM); };
    const Eigen::Quaterniond written(number("rot.w"), number("rot.x"), number("rot.y"), number("rot.z"));
    const auto rotation = UnitQuaternion(written);
    if (!rotation) {
      throw DataError("{}:{}: a quaternion of length {:g}, expected 1", file.string(), row + 2,
                      written.norm());
    }
    world_from_arm[table.Integer(row, "aris_frame_idx", 0, kMaxFrameIndex)] = {
        *rotation, {number("pos.x"), number("pos.y"), number("pos.z")}};
  }
  return world_from_arm;
}

class DfkiUxoRecording final : public RecordingSource {
 public:
  explicit DfkiUxoRecording(const fs::path& folder)
      : folder_(folder), table_(folder / "aris_frame_meta.csv") {
    FindFrames();
    const ArisHeader first = HeaderOf(table_, frames_.front().row);
    info_.source = folder.string();
    info_.format = "DFKI UXO data set, ARIS frames";
    DescribeAris(first, info_.source + ": frame 0", info_);
    NoteArisWindow(first, info_);
    info_.notes.emplace_back(
        "The reader follows the data set's published scripts; it was tried on a made-up copy only.");
    ReadPoses();
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(frames_.size()); }
  FrameInfo frame_info(int index) const override {
    return InfoOf(index, HeaderOf(table_, frames_.at(index).row));
  }

  Frame ReadFrame(int index) const override {
    const ArisHeader header = HeaderOf(table_, frames_.at(index).row);
    const fs::path file = Picture(frames_.at(index).number);
    Frame frame{InfoOf(index, header), {ArisAxes(header, file.string()), info_.scale, {}}};
    frame.image.value = ReadPgm(file, frame.image.axes.range_bins, frame.image.axes.beam_count());
    // ARIS beams are numbered from the right, columns from the left.
    for (int row = 0; row < frame.image.value.rows(); ++row) std::ranges::reverse(frame.image.value.row(row));
    return frame;
  }

 private:
  struct Entry {
    int row = 0;              // row of the table
    std::int64_t number = 0;  // its FrameIndex
  };

  fs::path Picture(std::int64_t number) const {
    return folder_ / "aris_raw" / fmt::format("{:04}.pgm", number);
  }
  fs::path Calibration() const {
    std::error_code error;
    return fs::weakly_canonical(folder_ / ".." / ".." / ".." / "calibration" / "transforms.yaml", error);
  }

  FrameInfo InfoOf(int index, const ArisHeader& header) const {
    const std::int64_t number = frames_.at(index).number;
    const auto arm = world_from_arm_.find(number);
    return {Picture(number).filename().string(),
            header.time_s > 0.0 ? std::optional(header.time_s) : std::nullopt,
            arm == world_from_arm_.end() ? std::nullopt : std::optional(arm->second * arm_from_sonar_),
            ArisSettings(header)};
  }

  void FindFrames() {
    int missing = 0;
    std::error_code error;
    for (int row = 0; row < table_.rows(); ++row) {
      const Entry entry{row, table_.Integer(row, "FrameIndex", 0, kMaxFrameIndex)};
      if (fs::is_regular_file(Picture(entry.number), error)) {
        frames_.push_back(entry);
      } else {
        ++missing;
      }
    }
    if (frames_.empty()) {
      throw DataError("{}: none of the {} frames of aris_frame_meta.csv has a picture in aris_raw",
                      folder_.string(), table_.rows());
    }
    if (missing > 0)
      info_.notes.push_back(fmt::format("{} frames have no picture in aris_raw and were omitted.", missing));
  }

  void ReadPoses() {
    std::error_code error;
    const fs::path arm = folder_ / "ar3.csv";
    const fs::path calibration = Calibration();
    if (!fs::exists(arm, error) || !fs::exists(calibration, error)) {
      info_.notes.push_back(fmt::format("There is no {}: frames have no pose.",
                                        fs::exists(arm, error) ? calibration.string() : arm.string()));
      return;
    }
    const FrameTree tree(calibration);
    const std::optional<Pose> arm_from_calibration = tree.Find("setup/ar3", "setup/sonar");
    if (!arm_from_calibration) {
      throw DataError("{}: no chain leads from setup/ar3 to setup/sonar, expected one", calibration.string());
    }
    arm_from_sonar_ = *arm_from_calibration * CalibrationFromSonar();
    world_from_arm_ = ReadArm(arm);
    const auto without = std::ranges::count_if(
        frames_, [&](const Entry& entry) { return !world_from_arm_.contains(entry.number); });
    if (without > 0) info_.notes.push_back(fmt::format("{} frames are not in ar3.csv: no pose.", without));
    CompareGantry(tree);
    DescribeTarget(tree);
  }

  // The arm is mounted on the gantry, which does not rotate.
  void CompareGantry(const FrameTree& tree) {
    constexpr double kSameM = 1e-3;
    const fs::path file = folder_ / "gantry.csv";
    const std::optional<Pose> gantry_from_arm = tree.Find("setup/portal_crane", "setup/ar3");
    std::error_code error;
    if (!fs::exists(file, error) || !gantry_from_arm) return;
    const CsvTable table(file);
    int differ = 0;
    for (int row = 0; row < table.rows(); ++row) {
      const auto number = [&](const char* column) { return table.Number(row, column, -kMaxM, kMaxM); };
      const auto arm = world_from_arm_.find(table.Integer(row, "aris_frame_idx", 0, kMaxFrameIndex));
      const Eigen::Vector3d hung =
          Eigen::Vector3d(number("x"), number("y"), number("z")) + gantry_from_arm->position_m;
      if (arm != world_from_arm_.end() && (arm->second.position_m - hung).norm() > kSameM) ++differ;
    }
    if (differ > 0) {
      info_.notes.push_back(fmt::format(
          "In {} frames the arm's position in gantry.csv differs from ar3.csv; ar3.csv is used.", differ));
    }
  }

  // The target has the name of the folder of its recordings.
  void DescribeTarget(const FrameTree& tree) {
    const std::string target = PlainFolder(folder_).parent_path().filename().string();
    const std::optional<Pose> pose = tree.Find("world", "target/" + target);
    if (!pose) return;
    const Eigen::Quaterniond& q = pose->rotation;
    info_.details.emplace_back(
        "target", fmt::format("{} at ({:g}, {:g}, {:g}) m, quaternion_wxyz ({:g}, {:g}, {:g}, {:g})",
                              Printable(target), pose->position_m.x(), pose->position_m.y(),
                              pose->position_m.z(), q.w(), q.x(), q.y(), q.z()));
  }

  fs::path folder_;
  CsvTable table_;
  std::vector<Entry> frames_;
  Pose arm_from_sonar_;
  std::map<std::int64_t, Pose> world_from_arm_;  // by FrameIndex
  RecordingInfo info_;
};

}  // namespace

bool IsDfkiUxo(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path / "aris_frame_meta.csv", error) &&
         fs::is_directory(path / "aris_raw", error);
}

std::unique_ptr<RecordingSource> OpenDfkiUxo(const fs::path& path) {
  return std::make_unique<DfkiUxoRecording>(path);
}

}  // namespace sonarcal::data_io
