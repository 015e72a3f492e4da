// Properties of sonar and image in a ping of an Oculus, for every type of recording.
#pragma once

#include <string>

#include "core/types/recording.h"
#include "data_io/sonars/oculus_ping.h"

namespace sonarcal::data_io {

// Requires a ping with bearings.
bool BearingsRunRightToLeft(const OculusPing& ping);

// Columns from left to right. Throws DataError, naming `what`, if bearings or resolution are not valid axes.
PolarAxes OculusAxes(const OculusPing& ping, const std::string& what);

ImageScale OculusScale(const OculusPing& ping);

// Sonar, scale, display gamma, water and settings of the first ping, with notes on assumptions and invalid
// values. info.source must be set.
void DescribeOculus(const OculusPing& ping, RecordingInfo& info);

}  // namespace sonarcal::data_io
