// Converts marine_acoustic_msgs/ProjectedSonarImage to a polar image; rules in data_io/ros/sonar_message.h.
#pragma once

#include <string>

#include "core/types/recording.h"
#include "data_io/ros/ros_messages.h"
#include "data_io/ros/sonar_message.h"

namespace sonarcal::data_io {

// Notes that SonarInfo (data_io/ros/sonar_info.h) removes.
inline constexpr const char* kNoSettingsRecorded = "Neither gain, TVG, dB scale nor water is recorded.";
inline constexpr const char* kFloatsAreTakenAsPower =
    "The quantity of the samples is not recorded; floats are read as linear power.";

PolarImage ImageOf(const ProjectedSonarImage& message, const std::string& where,
                   const SonarMessageOptions& options);

void Describe(const ProjectedSonarImage& message, const std::string& where,
              const SonarMessageOptions& options, RecordingInfo& info);

}  // namespace sonarcal::data_io
