#include "data_io/sonars/oculus_ping.h"

#include <array>
#include <string>

#include "core/types/error.h"

namespace sonarcal::data_io {
namespace {

constexpr std::uint8_t kFlagRangeInMetres = 1 << 0;
constexpr std::uint8_t kFlagSendGain = 1 << 2;

// Positions of the fields of a ping result, from the message's head.
struct Layout {
  std::uint64_t ping_id;  // followed by the fields up to the pressure in every version
  std::uint64_t sound_speed;
  std::uint64_t data_size;     // followed by resolution, ranges and beams
  std::uint64_t image_offset;  // followed by image size and message size
  std::uint64_t end;           // start of the bearings
};

constexpr Layout LayoutOfVersion1() {
  constexpr std::uint64_t kPing = 53;
  return {kPing, kPing + 32, kPing + 44, kPing + 57, kPing + 69};
}

constexpr Layout LayoutOfVersion2(std::uint64_t extended_flags_bytes) {
  const std::uint64_t ping = 53 + extended_flags_bytes;
  return {ping, ping + 56, ping + 72, ping + 101, ping + 113};
}

constexpr Layout kVersion1 = LayoutOfVersion1();
constexpr Layout kVersion2 = LayoutOfVersion2(36);
constexpr Layout kVersion2WithoutExtendedFlags = LayoutOfVersion2(0);

// Contradiction between a ping's fields; empty if there is none.
std::string Contradiction(const ByteReader& reader, const Layout& layout, const OculusPing& ping,
                          const OculusHead& head) {
  if (ping.bytes_per_sample > 4) {
    return fmt::format("{}: {}, expected 0..3", reader.Where(layout.data_size, "data size"),
                       ping.bytes_per_sample - 1);
  }
  if (!(ping.range_resolution_m > 0.0 && ping.range_resolution_m <= 10.0)) {
    return fmt::format("{}: {} m, expected more than 0 and at most 10",
                       reader.Where(layout.data_size + 1, "range resolution"), ping.range_resolution_m);
  }
  if (ping.ranges < 1) {
    return fmt::format("{}: 0, expected at least 1", reader.Where(layout.data_size + 9, "ranges"));
  }
  if (ping.beams < 2) {
    return fmt::format("{}: {}, expected at least 2", reader.Where(layout.data_size + 11, "beams"),
                       ping.beams);
  }
  const std::uint64_t image_bytes = ping.row_bytes() * ping.ranges;
  const std::uint32_t image_size = reader.U32(layout.image_offset + 4, "image size");
  if (image_size != image_bytes) {
    return fmt::format("{}: {}, expected {} for {} ranges x {} beams of {} bytes{}",
                       reader.Where(layout.image_offset + 4, "image size"), image_size, image_bytes,
                       ping.ranges, ping.beams, ping.bytes_per_sample, ping.has_gains ? " with gains" : "");
  }
  const std::uint64_t bearings_end = layout.end + 2 * static_cast<std::uint64_t>(ping.beams);
  if (ping.image_offset < bearings_end || ping.image_offset + image_bytes > head.message_bytes) {
    return fmt::format("{}: {}, expected {} bytes of image between byte {} and {} of the message",
                       reader.Where(layout.image_offset, "image offset"), ping.image_offset, image_bytes,
                       bearings_end, head.message_bytes);
  }
  return {};
}

OculusPing ReadFields(const ByteReader& reader, const Layout& layout, int version) {
  OculusPing ping;
  ping.version = version;
  ping.mode = reader.U8(16, "mode");
  ping.gamma = reader.U8(19, "gamma");
  const std::uint8_t flags = reader.U8(20, "flags");
  ping.range_is_metres = (flags & kFlagRangeInMetres) != 0;
  ping.has_gains = (flags & kFlagSendGain) != 0;
  ping.range_setting = reader.F64(21, "range");
  ping.gain_percent = reader.F64(29, "gain");
  ping.salinity_ppt = reader.F64(45, "salinity");
  ping.ping_id = reader.U32(layout.ping_id, "ping id");
  ping.frequency_hz = reader.F64(layout.ping_id + 8, "frequency");
  ping.temperature_c = reader.F64(layout.ping_id + 16, "temperature");
  ping.pressure_bar = reader.F64(layout.ping_id + 24, "pressure");
  if (version == 2) {
    ping.heading_deg = reader.F64(layout.ping_id + 32, "heading");
    ping.pitch_deg = reader.F64(layout.ping_id + 40, "pitch");
    ping.roll_deg = reader.F64(layout.ping_id + 48, "roll");
    ping.start_s = reader.F64(layout.sound_speed + 8, "start");
  }
  ping.sound_speed_m_per_s = reader.F64(layout.sound_speed, "sound speed");
  ping.bytes_per_sample = 1 + reader.U8(layout.data_size, "data size");
  ping.range_resolution_m = reader.F64(layout.data_size + 1, "range resolution");
  ping.ranges = reader.U16(layout.data_size + 9, "ranges");
  ping.beams = reader.U16(layout.data_size + 11, "beams");
  ping.image_offset = reader.U32(layout.image_offset, "image offset");
  return ping;
}

}  // namespace

std::optional<OculusHead> ParseOculusHead(const ByteReader& reader) {
  if (reader.size() < kOculusHeadBytes || reader.U16(0, "id") != kOculusId) return std::nullopt;
  return OculusHead{.message_id = reader.U16(6, "message id"),
                    .version = reader.U16(8, "version"),
                    .message_bytes = kOculusHeadBytes + reader.U32(10, "payload size")};
}

OculusPing ParseOculusPing(const ByteReader& reader, const OculusHead& head) {
  if (head.version > 2) {
    throw DataError("{}: {}, expected at most 2", reader.Where(8, "version"), head.version);
  }
  const int version = head.version == 2 ? 2 : 1;
  Layout layout = version == 2 ? kVersion2 : kVersion1;
  OculusPing ping = ReadFields(reader, layout, version);
  std::string contradiction = Contradiction(reader, layout, ping, head);
  if (!contradiction.empty() && version == 2) {
    const OculusPing shorter = ReadFields(reader, kVersion2WithoutExtendedFlags, version);
    if (Contradiction(reader, kVersion2WithoutExtendedFlags, shorter, head).empty()) {
      layout = kVersion2WithoutExtendedFlags;
      ping = shorter;
      contradiction.clear();
    }
  }
  if (!contradiction.empty()) throw DataError("{}", contradiction);

  ping.bearing_centideg.resize(ping.beams);
  for (int beam = 0; beam < ping.beams; ++beam) {
    ping.bearing_centideg[beam] = reader.I16(layout.end + 2 * static_cast<std::uint64_t>(beam), "bearings");
  }
  return ping;
}

}  // namespace sonarcal::data_io
