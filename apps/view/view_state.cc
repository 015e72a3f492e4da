#include "apps/view/view_state.h"

#include <fmt/format.h>

#include <limits>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "core/types/parse_number.h"
#include "core/types/printable.h"
#include "core/types/units.h"
#include "data_io/json/json_fields.h"
#include "data_io/json/json_reader.h"
#include "data_io/json/parameter_json.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::view {
namespace {

const data_io::NumberRange kPositionM = data_io::NumberRange::Between(-1e5, 1e5);
const data_io::NumberRange kAngleDeg = data_io::NumberRange::Between(-360.0, 360.0);

Pose ReadAnglePose(const data_io::JsonReader& json) {
  const data_io::JsonReader position_json = json.At("position_m");
  const std::vector<double> position_m = position_json.Numbers(kPositionM);
  if (position_m.size() != 3) {
    position_json.Fail(fmt::format("has {} numbers, expected 3", position_m.size()));
  }
  const auto angle_rad = [&](const char* key) { return RadFromDeg(json.At(key).Number(kAngleDeg)); };
  return {RotationFromYawPitchRoll(angle_rad("yaw_deg"), angle_rad("pitch_deg"), angle_rad("roll_deg")),
          {position_m[0], position_m[1], position_m[2]}};
}

std::map<int, Pose> ReadPoses(const data_io::JsonReader& json, int frame_count) {
  std::map<int, Pose> poses;
  for (const auto& [key, pose] : json.Members()) {
    int frame = -1;
    if (!ParseNumber(key, frame) || frame < 0 || frame >= frame_count) {
      json.Fail(fmt::format("moves frame '{}', expected one of 0 to {}", Printable(key), frame_count - 1));
    }
    poses[frame] = ReadAnglePose(pose);
  }
  return poses;
}

// Azimuths of `count` beams over `field_of_view_rad` from edge to edge.
std::vector<double> SpreadBeams(const PolarAxes& axes, int count, double field_of_view_rad) {
  std::vector<double> azimuth_rad(static_cast<std::size_t>(count));
  const double middle_rad = 0.5 * (axes.BeamEdgeRad(0) + axes.BeamEdgeRad(axes.beam_count()));
  if (count == axes.beam_count()) {
    const double factor = field_of_view_rad / axes.field_of_view_rad();
    for (std::size_t i = 0; i < azimuth_rad.size(); ++i) {
      azimuth_rad[i] = middle_rad + factor * (axes.beam_azimuth_rad[i] - middle_rad);
    }
    return azimuth_rad;
  }
  for (std::size_t i = 0; i < azimuth_rad.size(); ++i) {
    azimuth_rad[i] = middle_rad + field_of_view_rad * ((static_cast<double>(i) + 0.5) / count - 0.5);
  }
  return azimuth_rad;
}

}  // namespace

double FieldOfViewDeg(const PolarAxes& axes) {
  return DegFromRad(axes.field_of_view_rad());
}

SonarChanges SonarAsShown(const SonarModel& sonar) {
  return {.frequency_hz = sonar.frequency_hz,
          .range_min_m = sonar.axes.range_min_m,
          .range_max_m = sonar.axes.range_max_m,
          .range_bins = sonar.axes.range_bins,
          .beams = sonar.axes.beam_count(),
          .field_of_view_deg = FieldOfViewDeg(sonar.axes),
          .azimuth_beam_width_deg = sonar.azimuth_beam_width_deg,
          .elevation_beam_width_deg = sonar.elevation_beam_width_deg};
}

bool IsRecorded(std::string_view key) {
  return key.starts_with("range_") || key == "beams" || key == "field_of_view_deg";
}

SonarModel Changed(const SonarModel& sonar, const SonarChanges& changes) {
  SonarModel changed = sonar;
  const auto take = [](const std::optional<double>& from, double& to) { to = from.value_or(to); };
  take(changes.frequency_hz, changed.frequency_hz);
  take(changes.range_min_m, changed.axes.range_min_m);
  take(changes.range_max_m, changed.axes.range_max_m);
  take(changes.azimuth_beam_width_deg, changed.azimuth_beam_width_deg);
  take(changes.elevation_beam_width_deg, changed.elevation_beam_width_deg);
  changed.axes.range_bins = changes.range_bins.value_or(changed.axes.range_bins);
  if (!(changed.axes.range_max_m > changed.axes.range_min_m)) {
    throw DataError("sonar: range_max_m is {:g}, expected more than range_min_m, {:g}",
                    changed.axes.range_max_m, changed.axes.range_min_m);
  }
  if (changes.beams || changes.field_of_view_deg) {
    changed.axes.beam_azimuth_rad =
        SpreadBeams(sonar.axes, changes.beams.value_or(sonar.axes.beam_count()),
                    RadFromDeg(changes.field_of_view_deg.value_or(FieldOfViewDeg(sonar.axes))));
  }
  changed.axes.Validate("sonar");
  if (changes == SonarChanges()) return changed;
  for (double& azimuth_rad : changed.axes.beam_azimuth_rad)
    azimuth_rad = data_io::AzimuthAsWrittenRad(azimuth_rad);
  return changed;
}

ViewState ParseViewState(std::string_view text, int frame_count) {
  const data_io::JsonReader json = data_io::JsonReader::FromText(text, "request");
  ViewState state;
  const data_io::JsonReader parameters = json.At("parameters");
  if (!parameters.is_object()) parameters.Fail("is no object, expected that of params.json");
  if (const auto sonar = json.Find("sonar")) data_io::ReadGroup(*sonar, state.sonar);
  if (const auto frame = json.Find("frame"))
    state.frame = static_cast<int>(frame->Integer(0, frame_count - 1));
  if (const auto poses = json.Find("poses")) state.poses = ReadPoses(*poses, frame_count);
  if (const auto noise = json.Find("noise")) state.noise = noise->Bool();
  if (const auto seed = json.Find("seed")) {
    state.seed = static_cast<std::uint64_t>(seed->Integer(0, std::numeric_limits<std::int32_t>::max()));
  }
  if (const auto client = json.Find("client")) state.client = client->String();
  if (const auto sequence = json.Find("sequence")) {
    state.sequence = sequence->Integer(0, std::int64_t{1} << 53);
  }
  json.Finish();
  // Parses parameters as a file, so that their format and errors are defined in one place.
  state.parameters = data_io::ParseParameters(nlohmann::json::parse(text)["parameters"].dump(), "parameters");
  return state;
}

nlohmann::ordered_json AnglePoseJson(const Pose& pose) {
  const Eigen::Vector3d yaw_pitch_roll = YawPitchRollFromRotation(pose.rotation);
  return {{"position_m", {pose.position_m.x(), pose.position_m.y(), pose.position_m.z()}},
          {"yaw_deg", DegFromRad(yaw_pitch_roll[0])},
          {"pitch_deg", DegFromRad(yaw_pitch_roll[1])},
          {"roll_deg", DegFromRad(yaw_pitch_roll[2])}};
}

}  // namespace sonarcal::view
