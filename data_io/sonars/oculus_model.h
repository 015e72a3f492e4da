// Properties of sonar and image in a ping of an Oculus, for every type of recording.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/types/recording.h"
#include "data_io/sonars/oculus_ping.h"

namespace sonarcal::data_io {

// Requires a ping with bearings.
bool BearingsRunRightToLeft(const OculusPing& ping);

// Columns from left to right. Throws DataError, naming `what`, if bearings or resolution are not valid axes.
PolarAxes OculusAxes(const OculusPing& ping, const std::string& what);

ImageScale OculusScale(const OculusPing& ping);

// Samples of an image of row_bytes() per range, divided by the gains of the rows: ranges x beams, in the
// order of the bearings. Throws DataError, beginning with `where`, if the image is shorter or a gain is 0.
Grid<float> OculusSamples(const OculusPing& ping, std::span<const std::byte> image, const std::string& where);

// Image with its columns from left to right, of samples in the order of the bearings. Throws DataError,
// naming `what`, if bearings or resolution are not valid axes.
PolarImage OculusImage(const OculusPing& ping, Grid<float> samples, const std::string& what);

// Sonar, scale, display gamma, water and settings of the first ping, with notes on assumptions and invalid
// values. info.source must be set.
void DescribeOculus(const OculusPing& ping, RecordingInfo& info);

}  // namespace sonarcal::data_io
