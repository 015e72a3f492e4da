// Properties of sonar and image in the header of an ARIS frame, for every type of recording.
#pragma once

#include <cstdint>
#include <string>

#include "core/sonars/aris_beam_tables.h"
#include "core/types/recording.h"

namespace sonarcal::data_io {

inline constexpr std::uint32_t kMaxArisSamplesPerBeam = 1 << 16;

// Fields with the manufacturer's names: data_io/sonars/aris_io.h.
struct ArisHeader {
  double time_s = 0.0;  // since 1970; 0 = not set
  float window_start_m = 0.0f;
  float window_length_m = 0.0f;
  std::uint32_t gain_db = 0;
  float water_temperature_c = 0.0f;
  std::uint32_t ping_mode = 0;
  bool high_frequency = false;
  std::uint32_t pulse_width_us = 0;
  std::uint32_t cycle_period_us = 0;  // time between two pings; 0 = unknown
  std::uint32_t sample_period_us = 0;
  float frame_rate_hz = 0.0f;
  float sound_speed_m_per_s = 0.0f;
  std::uint32_t samples_per_beam = 0;
  std::uint32_t sample_start_delay_us = 0;
  ArisLens lens = ArisLens::kStandard;
  ArisSystem system = ArisSystem::kAris1800;
  bool by_beam = true;  // samples are sorted by beam, not in the order of sending
  std::uint32_t salinity_ppt = 0;

  int beam_count() const {
    if (ping_mode <= 2) return 48;
    if (ping_mode <= 5) return 96;
    if (ping_mode <= 8) return 64;
    return 128;
  }
  double bin_m() const { return sample_period_us * 1e-6 * sound_speed_m_per_s / 2.0; }
  double range_min_m() const { return sample_start_delay_us * 1e-6 * sound_speed_m_per_s / 2.0; }
  double range_max_m() const { return range_min_m() + samples_per_beam * bin_m(); }
};

// Columns from left to right. Throws DataError, naming `what`, if the manufacturer has no table of such
// beams.
PolarAxes ArisAxes(const ArisHeader& header, const std::string& what);

// Sonar, scale, water and settings of the first frame, with notes on assumptions and invalid values.
void DescribeAris(const ArisHeader& header, const std::string& what, RecordingInfo& info);

// Settings in a frame's header; time-varying gain is not recorded. A gain or pulse beyond the limits of
// recording.json is left out.
SonarSettings ArisSettings(const ArisHeader& header);

// Adds a note if the window of the header differs from that of the sample timing.
void NoteArisWindow(const ArisHeader& header, RecordingInfo& info);

}  // namespace sonarcal::data_io
