// What a ping of an Oculus says of its sonar and its image, whichever way it was recorded.
#pragma once

#include <string>

#include "core/types/recording.h"
#include "data_io/sonars/oculus_ping.h"

namespace sonarcal::data_io {

// The ping has bearings.
bool BearingsRunRightToLeft(const OculusPing& ping);

// Columns from left to right. Throws DataError naming `what` where bearings or resolution are no axes.
PolarAxes OculusAxes(const OculusPing& ping, const std::string& what);

ImageScale OculusScale(const OculusPing& ping);

// Sonar, scale, display gamma, water and settings of the first ping, with notes on what is presumed or
// garbage. info.source is set already.
void DescribeOculus(const OculusPing& ping, RecordingInfo& info);

}  // namespace sonarcal::data_io
