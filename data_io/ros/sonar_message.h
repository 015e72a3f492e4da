// What a sonar's ROS message becomes: a polar image, and what is known of the sonar.
//
// marine_acoustic_msgs/ProjectedSonarImage (also of the package's old name, acoustic_msgs):
//   - Azimuth of a beam = atan2(y, z) of its direction, positive to the right, as Z points ahead and X up.
//   Where no
//     beam has a Z part but all have an X part, as simulators write, X is taken to point ahead and Y to the
//     left.
//   - `ranges` are the centres of the bins, which must be even to a twentieth of one. Where they begin nearer
//     than half a bin, they are taken for the bins' near edges.
//   - Samples: the message has beams x ranges of them whichever stands first, so that sizes never tell the
//   order.
//     The definition says beam by beam; drivers and simulators are known that write range by range. A note
//     says which order the neighbours of the first frame speak for.
//   - Whole numbers are grey, full scale the largest of their type; floats are taken for linear power.
//   - Beam widths: the mean of rx in azimuth, of tx in elevation.
//
// sensor_msgs/Image and CompressedImage: grey pictures, where data_io/pictures/picture_geometry.h says how
// their pixels lie.
//
// sonar_oculus/OculusPing: as data_io/sonars/oculus_model.h, the picture's rows being ranges. Row gains are
// not in it.
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
  SampleOrder sample_order = SampleOrder::kByBeam;  // of ProjectedSonarImage
  bool mirrored = false;                            // exchange left and right
  std::optional<PictureGeometry> geometry = {};     // of bare pictures, which are read only with it

  bool operator==(const SonarMessageOptions&) const = default;
};

// Whether messages of the type are pings of a sonar, geometry included.
bool IsSonarType(const std::string& type);

// Whether they are bare pictures.
bool IsPictureType(const std::string& type);

// One message of a sonar's type, or of pictures where options.geometry is there. Throws DataError beginning
// with `where` where it is damaged, or no image.
PolarImage DecodeSonarMessage(const std::string& type, std::span<const std::byte> bytes,
                              MessageEncoding encoding, const std::string& where,
                              const SonarMessageOptions& options);

// Fills in sonar, scale, details and notes from the first message.
void DescribeSonarMessage(const std::string& type, std::span<const std::byte> bytes, MessageEncoding encoding,
                          const std::string& where, const SonarMessageOptions& options, RecordingInfo& info);

}  // namespace sonarcal::data_io
