// marine_acoustic_msgs/ProjectedSonarImage as a polar image; rules in data_io/sonar_message.h.
#pragma once

#include <string>

#include "data_io/ros_messages.h"
#include "data_io/sonar_message.h"
#include "data_io/types/recording.h"

namespace sonarcal {

PolarImage ImageOf(const ProjectedSonarImage& message, const std::string& where,
                   const SonarMessageOptions& options);

void Describe(const ProjectedSonarImage& message, const std::string& where,
              const SonarMessageOptions& options, RecordingInfo& info);

}  // namespace sonarcal
