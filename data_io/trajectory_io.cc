#include "data_io/trajectory_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "core/types/error.h"
#include "core/types/parse_number.h"
#include "core/types/printable.h"
#include "core/types/rotation.h"
#include "core/types/units.h"
#include "data_io/files/byte_reader.h"
#include "data_io/files/file_bytes.h"
#include "data_io/json/json_fields.h"
#include "data_io/json/json_reader.h"

namespace sonarcal::data_io {
namespace {

constexpr std::size_t kMaxTrajectoryBytes = 1 << 30;

struct Line {
  int number = 0;  // starts at 1
  std::string_view text;
};

std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

// Lines that are not empty, including comments.
std::vector<Line> LinesOf(std::string_view bytes) {
  std::vector<Line> lines;
  for (int number = 1; !bytes.empty(); ++number) {
    const std::size_t end = bytes.find('\n');
    const std::string_view text = Trimmed(bytes.substr(0, end));
    if (!text.empty()) lines.push_back({number, text});
    bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
  }
  return lines;
}

enum class Separator { kBlanks, kComma };

std::vector<std::string_view> Fields(std::string_view line, Separator separator) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t end = line.find_first_of(separator == Separator::kComma ? "," : " \t");
    const std::string_view field = Trimmed(line.substr(0, end));
    // Several blanks are one separator; several commas are not.
    if (separator == Separator::kComma || !field.empty()) fields.push_back(field);
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
  }
}

// Numbers of a line, with messages that name its place.
class LineReader {
 public:
  LineReader(const std::string& file, const Line& line, Separator separator)
      : file_(file), line_(line), fields_(Fields(line.text, separator)) {}

  double Number(std::size_t column, std::string_view name) const {
    double value = 0.0;
    const std::string_view field = Field(column, name);
    if (!ParseNumber(field, value) || !std::isfinite(value))
      Fail(fmt::format("{} is '{}', expected a finite number", name, Printable(field)));
    return value;
  }

  // Integer nanoseconds, converted to seconds.
  double Nanoseconds(std::size_t column) const {
    std::int64_t value = 0;
    const std::string_view field = Field(column, "the time");
    if (!ParseNumber(field, value))
      Fail(fmt::format("the time is '{}', expected whole nanoseconds in a euroc file; {}", Printable(field),
                       kTrajectoryColumns));
    constexpr std::int64_t kPerSecond = 1'000'000'000;
    const std::int64_t seconds = value / kPerSecond;
    return static_cast<double>(seconds) + 1e-9 * static_cast<double>(value % kPerSecond);
  }

  // Quaternion from four columns, in the order w, x, y, z.
  Eigen::Quaterniond Quaternion(const std::array<std::size_t, 4>& wxyz) const {
    const Eigen::Quaterniond q(Number(wxyz[0], "qw"), Number(wxyz[1], "qx"), Number(wxyz[2], "qy"),
                               Number(wxyz[3], "qz"));
    const auto rotation = UnitQuaternion(q);
    if (!rotation) Fail(fmt::format("the quaternion has length {:g}, expected 1", q.norm()));
    return *rotation;
  }

  [[noreturn]] void Fail(const std::string& what) const {
    throw DataError("{}:{}: {}", file_, line_.number, what);
  }

 private:
  std::string_view Field(std::size_t column, std::string_view name) const {
    if (column >= fields_.size())
      Fail(fmt::format("{} columns, expected {} in column {}", fields_.size(), name, column + 1));
    return fields_[column];
  }

  const std::string& file_;
  const Line& line_;
  std::vector<std::string_view> fields_;
};

// Positions of the columns of a csv.
struct Columns {
  std::size_t time = 0;
  std::array<std::size_t, 3> position{};
  std::array<std::size_t, 4> wxyz{};
  std::array<std::size_t, 3> yaw_pitch_roll{};
  bool has_quaternion = false;
};

Columns ColumnsOf(const std::string& file, const Line& header) {
  std::string_view text = header.text;
  if (text.front() == '#') text.remove_prefix(1);
  const std::vector<std::string_view> names = Fields(text, Separator::kComma);
  const auto has = [&](std::string_view name) { return std::ranges::count(names, name) > 0; };
  const auto column = [&](std::string_view name) {
    if (std::ranges::count(names, name) != 1) {
      throw DataError("{}:{}: {} columns are named '{}', expected one; {}", file, header.number,
                      std::ranges::count(names, name), name, kTrajectoryColumns);
    }
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  Columns columns{.time = column("time_s"), .position = {column("x_m"), column("y_m"), column("z_m")}};
  columns.has_quaternion = has("qw") || !has("yaw_deg");
  if (columns.has_quaternion) {
    columns.wxyz = {column("qw"), column("qx"), column("qy"), column("qz")};
  } else {
    columns.yaw_pitch_roll = {column("yaw_deg"), column("pitch_deg"), column("roll_deg")};
  }
  return columns;
}

TrajectoryPose ReadLine(const LineReader& line, TrajectoryFormat format, const Columns& columns) {
  const auto position = [&](std::size_t x, std::size_t y, std::size_t z) {
    return Eigen::Vector3d(line.Number(x, "x"), line.Number(y, "y"), line.Number(z, "z"));
  };
  switch (format) {
    case TrajectoryFormat::kTum:
      return {line.Number(0, "the time"), {line.Quaternion({7, 4, 5, 6}), position(1, 2, 3)}};
    case TrajectoryFormat::kEuroc:
      return {line.Nanoseconds(0), {line.Quaternion({4, 5, 6, 7}), position(1, 2, 3)}};
    case TrajectoryFormat::kCsv:
      break;
  }
  const auto angle_rad = [&](int which, std::string_view name) {
    return RadFromDeg(line.Number(columns.yaw_pitch_roll[which], name));
  };
  const Eigen::Quaterniond rotation =
      columns.has_quaternion ? line.Quaternion(columns.wxyz)
                             : RotationFromYawPitchRoll(angle_rad(0, "yaw_deg"), angle_rad(1, "pitch_deg"),
                                                        angle_rad(2, "roll_deg"));
  return {line.Number(columns.time, "time_s"),
          {rotation, position(columns.position[0], columns.position[1], columns.position[2])}};
}

}  // namespace

TrajectoryFormat GuessTrajectoryFormat(const std::filesystem::path& file) {
  // The first lines are sufficient, so the rest of a long recording is not read.
  constexpr std::uint64_t kFirstBytes = 64 << 10;
  const auto bytes = ReadFileRange(file, 0, std::min(RegularFileSize(file), kFirstBytes), "first lines");
  const std::vector<Line> lines = LinesOf({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!lines.empty() && lines.front().text.find("time_s") != std::string_view::npos)
    return TrajectoryFormat::kCsv;
  for (const Line& line : lines) {
    if (line.text.front() == '#') continue;
    if (line.text.find(',') != std::string_view::npos) return TrajectoryFormat::kEuroc;
    if (Fields(line.text, Separator::kBlanks).size() == 8) return TrajectoryFormat::kTum;
    break;
  }
  throw DataError("{}: no trajectory, expected one of these formats; {}", file.string(), kTrajectoryColumns);
}

std::vector<TrajectoryPose> ReadTrajectory(const std::filesystem::path& file, TrajectoryFormat format) {
  const std::string bytes = ReadFileBytes(file, kMaxTrajectoryBytes);
  const std::string name = file.string();
  std::vector<Line> lines = LinesOf(bytes);
  Columns columns;
  if (format == TrajectoryFormat::kCsv) {
    if (lines.empty()) throw DataError("{}: empty, expected a line that names the columns", name);
    columns = ColumnsOf(name, lines.front());
    lines.erase(lines.begin());
  }
  std::vector<TrajectoryPose> trajectory;
  for (const Line& line : lines) {
    if (line.text.front() == '#') continue;
    const LineReader reader(name, line,
                            format == TrajectoryFormat::kTum ? Separator::kBlanks : Separator::kComma);
    const TrajectoryPose pose = ReadLine(reader, format, columns);
    if (!trajectory.empty() && !(pose.time_s > trajectory.back().time_s)) {
      reader.Fail(fmt::format("time {:.6f} s after {:.6f} s, expected increasing times", pose.time_s,
                              trajectory.back().time_s));
    }
    trajectory.push_back(pose);
  }
  if (trajectory.empty()) throw DataError("{}: no pose, expected at least one", name);
  return trajectory;
}

std::optional<Pose> PoseAt(const std::vector<TrajectoryPose>& trajectory, double time_s, double most_gap_s) {
  const auto after =
      std::lower_bound(trajectory.begin(), trajectory.end(), time_s,
                       [](const TrajectoryPose& pose, double time) { return pose.time_s < time; });
  if (after == trajectory.end()) return std::nullopt;
  if (after->time_s == time_s) return after->world_from_body;
  if (after == trajectory.begin()) return std::nullopt;
  const auto before = after - 1;
  const double gap_s = after->time_s - before->time_s;
  if (!(gap_s <= most_gap_s)) return std::nullopt;
  const double part = (time_s - before->time_s) / gap_s;
  const Pose& a = before->world_from_body;
  const Pose& b = after->world_from_body;
  return Pose{a.rotation.slerp(part, b.rotation).normalized(),
              a.position_m + part * (b.position_m - a.position_m)};
}

Pose ReadMount(const std::filesystem::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  json.CheckFormat("sonar-mount/1");
  Pose body_from_sonar = ReadPose(json.At("body_from_sonar"));
  json.Finish();
  return body_from_sonar;
}

}  // namespace sonarcal::data_io
