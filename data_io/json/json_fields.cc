#include "data_io/json/json_fields.h"

#include <fmt/format.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/types/parameter_table.h"
#include "core/types/rotation.h"
#include "core/types/units.h"
#include "data_io/json/parameter_json.h"

namespace sonarcal::data_io {
namespace {

std::vector<double> ReadVector(const JsonReader& json, std::size_t size) {
  // The limit keeps squares finite and exceeds any distance on Earth.
  std::vector<double> values = json.Numbers(NumberRange::Between(-1e9, 1e9));
  if (values.size() != size) json.Fail(fmt::format("has {} numbers, expected {}", values.size(), size));
  return values;
}

// Azimuths are stored in radians; rounding to twelve digits restores the values of the file.
double RoundedDegrees(double azimuth_rad) {
  return std::round(DegFromRad(azimuth_rad) * 1e10) / 1e10;
}

}  // namespace

Pose ReadPose(const JsonReader& json) {
  const std::vector<double> position = ReadVector(json.At("position_m"), 3);
  const JsonReader quaternion_json = json.At("quaternion_wxyz");
  const std::vector<double> wxyz = ReadVector(quaternion_json, 4);
  const Eigen::Quaterniond quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  const auto rotation = UnitQuaternion(quaternion);
  if (!rotation)
    quaternion_json.Fail(fmt::format("has length {:.6g}, expected a unit quaternion", quaternion.norm()));
  return {*rotation, {position[0], position[1], position[2]}};
}

nlohmann::ordered_json PoseJson(const Pose& pose) {
  const Eigen::Vector3d& p = pose.position_m;
  const Eigen::Quaterniond& q = pose.rotation;
  return {{"position_m", {p.x(), p.y(), p.z()}}, {"quaternion_wxyz", {q.w(), q.x(), q.y(), q.z()}}};
}

Water ReadWater(const JsonReader& json) {
  Water water;
  ReadGroup(json, water);
  return water;
}

nlohmann::ordered_json WaterJson(const Water& water) {
  return MemberJson(water);
}

nlohmann::ordered_json SonarJson(const SonarModel& sonar) {
  nlohmann::ordered_json json = {{"name", sonar.name}};
  const auto write_known = [&json](const char* key, double value) {
    if (value != 0.0) json[key] = value;
  };
  write_known("frequency_hz", sonar.frequency_hz);
  for (const double azimuth_rad : sonar.axes.beam_azimuth_rad) {
    json["beam_azimuth_deg"].push_back(RoundedDegrees(azimuth_rad));
  }
  write_known("azimuth_beam_width_deg", sonar.azimuth_beam_width_deg);
  write_known("elevation_beam_width_deg", sonar.elevation_beam_width_deg);
  json["range_min_m"] = sonar.axes.range_min_m;
  json["range_max_m"] = sonar.axes.range_max_m;
  json["range_bins"] = sonar.axes.range_bins;
  write_known("sound_speed_m_per_s", sonar.sound_speed_m_per_s);
  if (sonar.beam_forming != BeamForming::kUnknown) json["beam_forming"] = ToString(sonar.beam_forming);
  return json;
}

double AzimuthAsWrittenRad(double azimuth_rad) {
  return RadFromDeg(RoundedDegrees(azimuth_rad));
}

}  // namespace sonarcal::data_io
