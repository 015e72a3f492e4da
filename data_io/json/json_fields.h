// JSON forms that several files share: a pose, the water, a sonar and its motion.
//
//   {"position_m": [x, y, z], "quaternion_wxyz": [w, x, y, z]}
//   {"temperature_c": 15, "salinity_ppt": 0.5, "ph": 7, "depth_m": 1}
//   {"name": "P900-45", "frequency_hz", "beam_azimuth_deg": [...], "azimuth_beam_width_deg",
//    "elevation_beam_width_deg", "range_min_m", "range_max_m", "range_bins", "sound_speed_m_per_s",
//    "beam_forming": "array" | "lens", "pings": {"of_beam": [0, 1, ...], "period_s", "first_s"}}
//   {"velocity_m_per_s": [x, y, z], "turn_rate_deg_per_s": [x, y, z]}
//   [{"bins": [first, end], "bright": true}]
#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/imaging/saturation.h"
#include "core/types/pings.h"
#include "core/types/pose.h"
#include "core/types/sonar_model.h"
#include "data_io/json/json_reader.h"

namespace sonarcal::data_io {

// Normalises a quaternion within 1e-3 of unit length and rejects any other.
Pose ReadPose(const JsonReader& json);
nlohmann::ordered_json PoseJson(const Pose& pose);

// A vector that is absent is zero.
Motion ReadMotion(const JsonReader& json);
nlohmann::ordered_json MotionJson(const Motion& motion);

// Pings of a sonar with `beams` beams.
PingPattern ReadPings(const JsonReader& json, int beams);

// All four values are required and must lie within the limits of core/types/parameter_table.h.
Water ReadWater(const JsonReader& json);
nlohmann::ordered_json WaterJson(const Water& water);

// Streaks of an image (core/imaging/saturation.h).
nlohmann::ordered_json StreaksJson(const std::vector<AzimuthStreak>& streaks);

// Omits unknown values (0), as readers expect (data_io/recordings/recording_io.h).
nlohmann::ordered_json SonarJson(const SonarModel& sonar);

// Azimuth after a round trip through SonarJson.
double AzimuthAsWrittenRad(double azimuth_rad);

}  // namespace sonarcal::data_io
