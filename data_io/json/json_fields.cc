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

// The default limit keeps squares finite and exceeds any distance on Earth.
std::vector<double> ReadVector(const JsonReader& json, std::size_t size, double limit = 1e9) {
  std::vector<double> values = json.Numbers(NumberRange::Between(-limit, limit));
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

Motion ReadMotion(const JsonReader& json) {
  Motion motion;
  if (const auto velocity = json.Find("velocity_m_per_s")) {
    const std::vector<double> v = ReadVector(*velocity, 3, kMaxSpeedMPerS);
    motion.velocity_m_per_s = {v[0], v[1], v[2]};
  }
  if (const auto turn_rate = json.Find("turn_rate_deg_per_s")) {
    const std::vector<double> w = ReadVector(*turn_rate, 3, kMaxTurnRateDegPerS);
    motion.turn_rate_rad_per_s = {RadFromDeg(w[0]), RadFromDeg(w[1]), RadFromDeg(w[2])};
  }
  return motion;
}

nlohmann::ordered_json MotionJson(const Motion& motion) {
  const Eigen::Vector3d& v = motion.velocity_m_per_s;
  const Eigen::Vector3d& w = motion.turn_rate_rad_per_s;
  return {{"velocity_m_per_s", {v.x(), v.y(), v.z()}},
          {"turn_rate_deg_per_s", {RoundedDegrees(w.x()), RoundedDegrees(w.y()), RoundedDegrees(w.z())}}};
}

PingPattern ReadPings(const JsonReader& json, int beams) {
  constexpr double kMaxTimeS = 1000.0;
  PingPattern pings;
  const JsonReader of_beam = json.At("of_beam");
  for (const JsonReader& ping : of_beam.Items())
    pings.of_beam.push_back(static_cast<int>(ping.Integer(0, beams - 1)));
  if (static_cast<int>(pings.of_beam.size()) != beams) {
    of_beam.Fail(fmt::format("has {} numbers, expected one per beam, {}", pings.of_beam.size(), beams));
  }
  json.Update("period_s", pings.period_s, NumberRange::AboveUpTo(0.0, kMaxTimeS));
  json.Update("first_s", pings.first_s, NumberRange::Between(-kMaxTimeS, kMaxTimeS));
  return pings;
}

Water ReadWater(const JsonReader& json) {
  Water water;
  ReadGroup(json, water);
  return water;
}

nlohmann::ordered_json WaterJson(const Water& water) {
  return MemberJson(water);
}

nlohmann::ordered_json StreaksJson(const std::vector<AzimuthStreak>& streaks) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const AzimuthStreak& streak : streaks)
    json.push_back({{"bins", {streak.first_bin, streak.end_bin}}, {"bright", streak.bright}});
  return json;
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
  if (!sonar.pings.of_beam.empty()) {
    json["pings"]["of_beam"] = sonar.pings.of_beam;
    if (sonar.pings.period_s > 0.0) json["pings"]["period_s"] = sonar.pings.period_s;
    if (sonar.pings.first_s != 0.0) json["pings"]["first_s"] = sonar.pings.first_s;
  }
  return json;
}

double AzimuthAsWrittenRad(double azimuth_rad) {
  return RadFromDeg(RoundedDegrees(azimuth_rad));
}

}  // namespace sonarcal::data_io
