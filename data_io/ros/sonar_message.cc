#include "data_io/ros/sonar_message.h"

#include <algorithm>
#include <utility>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/ros/oculus_interfaces.h"
#include "data_io/ros/projected_sonar_image.h"
#include "data_io/ros/ros_messages.h"
#include "data_io/ros/ros_picture.h"
#include "data_io/sonars/oculus_model.h"

namespace sonarcal::data_io {
namespace {

constexpr const char* kPictureType = "sensor_msgs/Image";
constexpr const char* kCompressedPictureType = "sensor_msgs/CompressedImage";
constexpr const char* kMirrored = "Left and right are exchanged, as asked for.";

bool IsProjected(const std::string& type) {
  return type == "marine_acoustic_msgs/ProjectedSonarImage" || type == "acoustic_msgs/ProjectedSonarImage";
}

bool IsSonarOculusPing(const std::string& type) {
  return type == "sonar_oculus/OculusPing" || type == "sonar_oculus_interface/OculusPing";
}

// Converts the message to the sonar's own ping, with the checks that DescribeOculus requires.
OculusPingWithSamples PingOf(const RosOculusPing& message, const std::string& where) {
  constexpr std::uint8_t kRangeIsMetres = 1;
  RosPicture picture =
      message.is_compressed ? PictureOf(message.compressed, where) : PictureOf(message.image, where);
  if (message.beams < 2 || std::cmp_not_equal(picture.value.rows(), message.ranges) ||
      std::cmp_not_equal(picture.value.cols(), message.beams)) {
    throw DataError("{}: a picture of {} x {} pixels, expected {} ranges x {} beams, 2 beams at least", where,
                    picture.value.rows(), picture.value.cols(), message.ranges, message.beams);
  }
  OculusPing ping;
  ping.mode = message.mode;
  ping.gamma = message.gamma;
  ping.range_is_metres = (message.flags & kRangeIsMetres) != 0;
  ping.range_setting = message.range_setting;
  ping.gain_percent = message.gain_percent;
  ping.salinity_ppt = message.salinity_ppt;
  ping.ping_id = message.ping_id;
  ping.has_environment = message.has_environment;
  ping.frequency_hz = message.frequency_hz;
  ping.temperature_c = message.temperature_c;
  ping.pressure_bar = message.pressure_bar;
  ping.sound_speed_m_per_s = message.sound_speed_m_per_s;
  ping.range_resolution_m = message.range_resolution_m;
  ping.ranges = static_cast<int>(message.ranges);
  ping.beams = static_cast<int>(message.beams);
  ping.bytes_per_sample = picture.full_scale > 255.0 ? 2 : 1;
  ping.bearing_centideg = message.bearing_centideg;
  return {std::move(ping), std::move(picture.value)};
}

void Mirror(std::vector<std::int16_t>& bearing_centideg) {
  for (std::int16_t& bearing : bearing_centideg) bearing = static_cast<std::int16_t>(-bearing);
}

PolarImage ImageOf(OculusPingWithSamples with_samples, const std::string& where,
                   const SonarMessageOptions& options) {
  if (options.mirrored) Mirror(with_samples.ping.bearing_centideg);
  return OculusImage(with_samples.ping, std::move(with_samples.samples), where);
}

void Describe(OculusPing ping, const SonarMessageOptions& options, RecordingInfo& info) {
  if (options.mirrored) Mirror(ping.bearing_centideg);
  DescribeOculus(ping, info);
  if (options.mirrored) info.notes.emplace_back(kMirrored);
}

void Describe(const RosOculusPing& message, const std::string& where, const SonarMessageOptions& options,
              RecordingInfo& info) {
  constexpr std::uint8_t kRowGains = 4;
  const OculusPing ping = PingOf(message, where).ping;
  Describe(ping, options, info);
  if (!ping.has_environment && message.fire_sound_speed_m_per_s > 1300.0 &&
      message.fire_sound_speed_m_per_s < 1700.0) {
    info.sonar.sound_speed_m_per_s = message.fire_sound_speed_m_per_s;
    info.notes.emplace_back("The sound speed is the one that was asked for.");
  }
  if (message.is_compressed) info.details.emplace_back("picture", Printable(message.compressed.format));
  if ((message.flags & kRowGains) != 0)
    info.notes.emplace_back("The sonar was set to send row gains, but the message does not contain them.");
}

ImageScale ScaleOf(const RosPicture& picture, const PictureGeometry& geometry) {
  ImageScale scale;
  scale.full_scale = picture.full_scale;
  scale.db_span = geometry.db_span;
  return scale;
}

// A message is read alone, so a fan is not searched in several frames.
PictureSampler SamplerFor(const PictureGeometry& geometry, const RosPicture& picture,
                          const std::string& where) {
  if (!geometry.polar && !geometry.fan) {
    throw DataError(
        "{}: the picture's geometry has neither 'polar' nor the position of the fan, expected apex_px, "
        "radius_px and half_angle_deg of 'fan'",
        where);
  }
  return {geometry, picture.value.rows(), picture.value.cols(), where};
}

struct PolarPicture {
  PolarImage image;
  std::optional<Mask> inside;  // set if part of the image lies outside the picture
};

template <typename T>
void Mirror(Grid<T>& grid) {
  for (int row = 0; row < grid.rows(); ++row) std::ranges::reverse(grid.row(row));
}

PolarPicture ImageOfPicture(const std::string& type, std::span<const std::byte> bytes,
                            MessageEncoding encoding, const std::string& where,
                            const SonarMessageOptions& options) {
  SONARCAL_CHECK(IsPictureType(type) && options.geometry, "{}", type);
  MessageStream stream(bytes, encoding, where);
  const RosPicture picture = type == kPictureType ? PictureOf(ReadRosImage(stream), where)
                                                  : PictureOf(ReadRosCompressedImage(stream), where);
  const PictureSampler sampler = SamplerFor(*options.geometry, picture, where);
  PolarPicture polar{{sampler.axes(), ScaleOf(picture, *options.geometry), sampler.Apply(picture.value)},
                     sampler.inside()};
  if (options.mirrored) {
    Mirror(polar.image.value);
    if (polar.inside) Mirror(*polar.inside);
    std::vector<double>& azimuths_rad = polar.image.axes.beam_azimuth_rad;
    std::ranges::reverse(azimuths_rad);
    for (double& azimuth_rad : azimuths_rad) azimuth_rad = -azimuth_rad;
  }
  return polar;
}

void DescribePicture(const PolarPicture& picture, const SonarMessageOptions& options, RecordingInfo& info) {
  options.geometry->Describe(info);
  info.scale = picture.image.scale;
  info.sonar.axes = picture.image.axes;
  info.valid = picture.inside;
  info.notes.emplace_back("The message is a bare picture: window and beams are those of the given geometry.");
  info.notes.emplace_back("Neither gain nor water is recorded.");
  if (options.geometry->fan)
    info.notes.emplace_back(
        "Resampled from fan pictures, bilinear: neighbouring samples are not independent.");
  if (options.mirrored) info.notes.emplace_back(kMirrored);
}

}  // namespace

bool IsPictureType(const std::string& type) {
  return type == kPictureType || type == kCompressedPictureType;
}

bool IsPointsType(const std::string& type) {
  return type == "sensor_msgs/PointCloud" || type == "sensor_msgs/PointCloud2";
}

bool IsSonarType(const std::string& type) {
  return IsProjected(type) || IsSonarOculusPing(type) || IsOculusInterfacesType(type);
}

PolarImage DecodeSonarMessage(const std::string& type, std::span<const std::byte> bytes,
                              MessageEncoding encoding, const std::string& where,
                              const SonarMessageOptions& options) {
  if (IsProjected(type)) {
    MessageStream stream(bytes, encoding, where);
    return ImageOf(ReadProjectedSonarImage(stream), where, options);
  }
  if (IsOculusInterfacesType(type))
    return ImageOf(ReadOculusInterfaces(type, bytes, encoding, where), where, options);
  if (!IsSonarOculusPing(type)) return ImageOfPicture(type, bytes, encoding, where, options).image;
  return ImageOf(PingOf(ReadRosOculusPing(bytes, encoding, where), where), where, options);
}

void DescribeSonarMessage(const std::string& type, std::span<const std::byte> bytes, MessageEncoding encoding,
                          const std::string& where, const SonarMessageOptions& options, RecordingInfo& info) {
  if (IsProjected(type)) {
    MessageStream stream(bytes, encoding, where);
    Describe(ReadProjectedSonarImage(stream), where, options, info);
    return;
  }
  if (IsOculusInterfacesType(type)) {
    Describe(ReadOculusInterfaces(type, bytes, encoding, where).ping, options, info);
    return;
  }
  if (!IsSonarOculusPing(type)) {
    DescribePicture(ImageOfPicture(type, bytes, encoding, where, options), options, info);
    return;
  }
  Describe(ReadRosOculusPing(bytes, encoding, where), where, options, info);
}

}  // namespace sonarcal::data_io
