// Converts a sonar's ROS message to a polar image and the properties of the sonar.
//
// marine_acoustic_msgs/ProjectedSonarImage (also under the package's old name, acoustic_msgs):
//
// - Azimuth of a beam = atan2(y, z) of its direction, positive to the right, with Z forward and X up. If no
//   beam has a Z component but all have an X component, as simulators write, X is forward and Y to the left.
// - `ranges` are the centres of the bins, which must be even to a twentieth of one. If they begin nearer than
//   half a bin, they are the near edges of the bins.
// - Samples: the message has beams x ranges of them in either order, so sizes do not determine the order. The
//   definition says beam by beam; some drivers and simulators write range by range. A note states the order
//   that the neighbours of the first frame indicate.
// - Integers are grey, with the max of their type as full scale; floats are linear power.
// - Beam widths: the mean of rx in azimuth, of tx in elevation.
//
// sensor_msgs/Image and CompressedImage: grey pictures, with a geometry from
// data_io/pictures/picture_geometry.h.
//
// sonar_oculus/OculusPing: as data_io/sonars/oculus_model.h; rows of the picture are ranges. It contains no
// row gains.
//
// oculus_interfaces/Ping, OculusPing and OculusStampedPing: data_io/ros/oculus_interfaces.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <type_traits>

#include "core/types/recording.h"
#include "core/types/words.h"
#include "data_io/pictures/picture_geometry.h"
#include "data_io/ros/message_stream.h"

namespace sonarcal::data_io {

enum class SampleOrder { kByBeam, kByRange };
constexpr auto WordsOf(std::type_identity<SampleOrder>) {
  return Words<SampleOrder, 2>{{{"beam", SampleOrder::kByBeam}, {"range", SampleOrder::kByRange}}};
}

struct SonarMessageOptions {
  SampleOrder sample_order = SampleOrder::kByBeam;  // order in ProjectedSonarImage
  bool mirrored = false;                            // exchange left and right
  std::optional<PictureGeometry> geometry = {};     // geometry of bare pictures; required for them

  bool operator==(const SonarMessageOptions&) const = default;
};

// True if messages of the type are pings of a sonar, geometry included.
bool IsSonarType(const std::string& type);

// True if messages of the type are points, as drivers of mechanically scanning sonars write them. Points have
// neither beams nor range bins, so they are no image.
bool IsPointsType(const std::string& type);

// True if messages of the type are bare pictures.
bool IsPictureType(const std::string& type);

// One message of a sonar's type, or of pictures if options.geometry is set. Throws DataError, beginning with
// `where`, if it is damaged or not an image.
PolarImage DecodeSonarMessage(const std::string& type, std::span<const std::byte> bytes,
                              MessageEncoding encoding, const std::string& where,
                              const SonarMessageOptions& options);

// Fills sonar, scale, details and notes from the first message.
void DescribeSonarMessage(const std::string& type, std::span<const std::byte> bytes, MessageEncoding encoding,
                          const std::string& where, const SonarMessageOptions& options, RecordingInfo& info);

}  // namespace sonarcal::data_io
