// One simple ping result of an Oculus, without its image. Layout: data_io/sonars/oculus_io.h.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "data_io/files/byte_reader.h"

namespace sonarcal::data_io {

inline constexpr std::uint16_t kOculusId = 0x4f53;
inline constexpr std::uint16_t kOculusSimplePingResult = 0x23;
inline constexpr std::uint64_t kOculusHeadBytes = 16;

struct OculusHead {
  std::uint16_t message_id = 0;
  std::uint16_t version = 0;
  std::uint64_t message_bytes = 0;  // head included
};

// Returns nothing if the bytes do not begin with an Oculus head.
std::optional<OculusHead> ParseOculusHead(const ByteReader& reader);

struct OculusPing {
  int version = 1;
  // Settings.
  std::uint8_t mode = 0;
  std::uint8_t gamma = 0;
  bool range_is_metres = false;
  bool has_gains = false;  // each row of the image begins with a u32
  double range_setting = 0.0;
  double gain_percent = 0.0;
  double salinity_ppt = 0.0;
  bool has_settings = true;  // gamma and salinity are recorded
  // Result.
  std::uint32_t ping_id = 0;
  bool has_environment = true;  // frequency, temperature, pressure and sound speed
  double frequency_hz = 0.0;
  double temperature_c = 0.0;
  double pressure_bar = 0.0;
  double heading_deg = 0.0;  // version 2, as are pitch and roll
  double pitch_deg = 0.0;
  double roll_deg = 0.0;
  double sound_speed_m_per_s = 0.0;
  std::optional<double> start_s;  // since power-up; the unit of version 1 is not documented
  double range_resolution_m = 0.0;
  int ranges = 0;
  int beams = 0;
  int bytes_per_sample = 1;
  std::uint64_t image_offset = 0;  // from the message's head
  std::vector<std::int16_t> bearing_centideg;

  std::uint64_t row_bytes() const {
    return static_cast<std::uint64_t>(beams) * bytes_per_sample + (has_gains ? 4 : 0);
  }
  double full_scale() const { return static_cast<double>((std::uint64_t{1} << 8 * bytes_per_sample) - 1); }
};

// `reader` must hold the message at least up to the end of its bearings (kMaxOculusPingHeaderBytes suffice).
// Throws DataError if sizes, counts or resolution are impossible for a message of head.message_bytes.
OculusPing ParseOculusPing(const ByteReader& reader, const OculusHead& head);

inline constexpr std::uint64_t kMaxOculusPingHeaderBytes = 202 + 2 * 0xffff;

}  // namespace sonarcal::data_io
