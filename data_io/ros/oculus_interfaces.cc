#include "data_io/ros/oculus_interfaces.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "core/types/error.h"
#include "data_io/ros/ros_messages.h"
#include "data_io/sonars/oculus_model.h"

namespace sonarcal::data_io {
namespace {

bool IsPing(const std::string& type) {
  return type == "oculus_interfaces/Ping";
}

bool IsStampedPing(const std::string& type) {
  return type == "oculus_interfaces/OculusStampedPing" || type == "oculus_sonar/OculusStampedPing";
}

bool IsOculusPing(const std::string& type) {
  return type == "oculus_interfaces/OculusPing";
}

void SkipHeader(MessageStream& stream) {
  ReadStampNs(stream);
  stream.String("header.frame_id");
}

// Ping from the sonar's own message; nothing if the bytes do not begin with the head of one.
std::optional<OculusPingWithSamples> FromOwnMessage(std::span<const std::byte> bytes,
                                                    const std::string& where) {
  const ByteReader reader(bytes, where);
  const std::optional<OculusHead> head = ParseOculusHead(reader);
  if (!head || head->message_id != kOculusSimplePingResult) return std::nullopt;
  if (head->message_bytes > bytes.size()) {
    throw DataError("{}: the sonar's own message has {} bytes, of which {} are there", where,
                    head->message_bytes, bytes.size());
  }
  OculusPing ping = ParseOculusPing(reader, *head);
  Grid<float> samples =
      OculusSamples(ping, reader.Bytes(ping.image_offset, ping.row_bytes() * ping.ranges, "image"), where);
  return OculusPingWithSamples{std::move(ping), std::move(samples)};
}

// Fields of an OculusPing. All but the last repeat the sonar's own message.
OculusPingWithSamples ReadOculusPing(MessageStream& stream, const std::string& where) {
  constexpr int kHeadWords = 5;
  constexpr int kFireBytes = 5;
  constexpr int kFireNumbers = 4;
  constexpr int kEnvironment = 4;
  for (int i = 0; i < kHeadWords; ++i) stream.U16("fire_message.head");
  stream.U32("fire_message.head.payload_size");
  stream.U16("fire_message.head.spare2");
  for (int i = 0; i < kFireBytes; ++i) stream.U8("fire_message");
  for (int i = 0; i < kFireNumbers; ++i) stream.F64("fire_message");
  stream.U32("ping_id");
  stream.U32("status");
  for (int i = 0; i < kEnvironment; ++i) stream.F64("frequency to speed of sound");
  stream.U32("ping_start_time");
  stream.U8("data_size");
  stream.F64("range_resolution");
  stream.U16("n_ranges");
  stream.U16("n_beams");
  stream.U32("image_offset");
  stream.U32("image_size");
  stream.U32("message_size");
  const std::span<const std::byte> data = stream.Bytes("data");
  stream.Finish();
  std::optional<OculusPingWithSamples> ping = FromOwnMessage(data, where + ": data");
  if (!ping) throw DataError("{}: data has {} bytes, expected the sonar's own message", where, data.size());
  return *std::move(ping);
}

void CheckSizes(const OculusPing& ping, std::uint32_t step, std::size_t data_bytes,
                const std::string& where) {
  if (ping.ranges < 1 || ping.beams < 2 || ping.bytes_per_sample < 1 || ping.bytes_per_sample > 4 ||
      !(ping.range_resolution_m > 0.0 && ping.range_resolution_m <= 10.0)) {
    throw DataError(
        "{}: {} ranges of {:g} m x {} beams of {} bytes, expected at least 1 x 2, 0 to 10 m and 1 to 4 bytes",
        where, ping.ranges, ping.range_resolution_m, ping.beams, ping.bytes_per_sample);
  }
  if (ping.bearing_centideg.size() != static_cast<std::size_t>(ping.beams)) {
    throw DataError("{}: {} beams and {} bearings, expected one per beam", where, ping.beams,
                    ping.bearing_centideg.size());
  }
  if (step != ping.row_bytes() || data_bytes != ping.row_bytes() * ping.ranges) {
    throw DataError(
        "{}: ping_data has {} bytes with {} bytes per row, expected the sonar's own message, or an image of "
        "{} rows of {} bytes",
        where, data_bytes, step, ping.ranges, ping.row_bytes());
  }
}

OculusPingWithSamples ReadPing(MessageStream& stream, const std::string& where) {
  OculusPing ping;
  SkipHeader(stream);
  ping.has_settings = false;
  ping.ping_id = stream.U32("ping_id");
  stream.U32("ping_firing_date");
  ping.range_is_metres = true;
  ping.range_setting = stream.F64("range");
  ping.gain_percent = stream.F64("gain_percent");
  ping.frequency_hz = stream.F64("frequency");
  ping.sound_speed_m_per_s = stream.F64("speed_of_sound_used");
  ping.range_resolution_m = stream.F64("range_resolution");
  ping.temperature_c = stream.F64("temperature");
  ping.pressure_bar = stream.F64("pressure");
  ping.mode = stream.U8("master_mode");
  ping.has_gains = stream.U8("has_gains") != 0;
  ping.ranges = stream.U16("n_ranges");
  ping.beams = stream.U16("n_beams");
  const std::uint32_t step = stream.U32("step");
  ping.bytes_per_sample = stream.U8("sample_size");
  ping.bearing_centideg = stream.I16s("bearings");
  const std::span<const std::byte> data = stream.Bytes("ping_data");
  stream.Finish();
  if (auto own = FromOwnMessage(data, where + ": ping_data")) return *std::move(own);
  CheckSizes(ping, step, data.size(), where);
  Grid<float> samples = OculusSamples(ping, data, where + ": ping_data");
  return {std::move(ping), std::move(samples)};
}

}  // namespace

bool IsOculusInterfacesType(const std::string& type) {
  return IsPing(type) || IsStampedPing(type) || IsOculusPing(type);
}

OculusPingWithSamples ReadOculusInterfaces(const std::string& type, std::span<const std::byte> bytes,
                                           MessageEncoding encoding, const std::string& where) {
  MessageStream stream(bytes, encoding, where);
  if (IsPing(type)) return ReadPing(stream, where);
  SkipHeader(stream);
  if (!IsStampedPing(type)) return ReadOculusPing(stream, where);
  // The ping in an OculusStampedPing has a header of its own in ROS 2, but had none before.
  MessageStream without_header = stream;
  try {
    SkipHeader(stream);
    return ReadOculusPing(stream, where);
  } catch (const DataError& error) {
    try {
      return ReadOculusPing(without_header, where);
    } catch (const DataError&) {
      throw DataError("{}", error.what());
    }
  }
}

}  // namespace sonarcal::data_io
