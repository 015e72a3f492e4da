// Recordings and calibrated sonars as messages of marine_interfaces/SonarInfo (data_io/ros/sonar_info.h), in
// the newest version of its definition.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "data_io/ros/sonar_info.h"

namespace sonarcal::data_io {

inline constexpr const char* kSonarInfoTopic = "/sonar/sonar_info";

// Result of a calibration.
struct SonarCalibration {
  ParameterSet parameters;
  double absorption_db_per_m = 0.0;  // one way; for a time-varying gain that contains it
  std::string reference;             // identifies the calibration; not empty
  std::int64_t time_ns = 0;          // of the calibration, since 1970
};

// SonarInfo of frames with these settings:
//
//   pulse           of the settings, otherwise 2 L / c of the calibration's pulse of length L
//   TVG             of the calibration; otherwise none, or "custom", if the settings state it
//   scale           dB if the grey values follow the logarithm. Absolute if their levels and the source level
//                   are known. The calibration's gain of the receiver is subtracted from its levels.
//   source level    of the calibration, otherwise of the recording
//   beam pattern    sensitivity of each beam of the calibration over its azimuth
//
// Unknown values are left out.
SonarInfo SonarInfoOf(const RecordingInfo& info, const SonarSettings& settings,
                      const std::optional<SonarCalibration>& calibration);

std::string SonarInfoMessage(MessageEncoding encoding, const SonarInfo& sonar);

}  // namespace sonarcal::data_io
