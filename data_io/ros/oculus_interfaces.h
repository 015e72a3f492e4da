// Pings of an Oculus in the messages of oculus_interfaces (ENSTABretagneRobotics/oculus_ros2, 99d66a7):
//
//   OculusStampedPing, OculusPing   fields of a ping, then the sonar's own message as it was received
//   Ping                            fields of a ping, bearings, then `ping_data`. By the definition that is
//                                   the image. The driver puts the sonar's own message there.
//
// If a message contains the sonar's own message (data_io/sonars/oculus_ping.h), all is read from that. A Ping
// with an image alone states neither gamma nor salinity.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/types/image.h"
#include "data_io/ros/message_stream.h"
#include "data_io/sonars/oculus_ping.h"

namespace sonarcal::data_io {

// True for the types above, and for oculus_sonar/OculusStampedPing of the same driver for ROS 1.
bool IsOculusInterfacesType(const std::string& type);

struct OculusPingWithSamples {
  OculusPing ping;
  Grid<float> samples;  // ranges x beams, in the order of the bearings
};

// Throws DataError, beginning with `where`, if the message is not such a ping, or its sizes disagree.
OculusPingWithSamples ReadOculusInterfaces(const std::string& type, std::span<const std::byte> bytes,
                                           MessageEncoding encoding, const std::string& where);

}  // namespace sonarcal::data_io
