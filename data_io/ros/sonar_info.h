// marine_interfaces/SonarInfo (rolker/unh_marine_autonomy, definition of b4bbc7d): meaning of a sonar's
// samples, its pulse, and the corrections that the samples contain. It accompanies the images of a sonar on a
// topic of its own, and holds from its time until the next one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/types/recording.h"
#include "data_io/ros/message_stream.h"

namespace sonarcal::data_io {

// Values are those of the message.
enum class IntensityQuantity : std::uint8_t { kUnknown, kRawAdc, kAmplitude, kPower };
enum class IntensityScale : std::uint8_t { kUnknown, kLinear, kDecibel };
enum class IntensityReference : std::uint8_t { kUnknown, kRelative, kAbsolute };
enum class TvgModel : std::uint8_t { kUnknown, kNone, k20LogR, k40LogR, kCustom };

struct SonarInfo {
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

  std::int64_t stamp_ns = 0;
  std::string frame_id;
  std::string sonar_model;
  std::string calibration_ref;           // empty: not calibrated
  std::int64_t calibration_time_ns = 0;  // 0: not calibrated
  // One per sector of transmission; empty: unknown.
  std::vector<float> pulse_length_s;
  std::vector<float> bandwidth_hz;
  std::vector<std::uint8_t> signal_type;
  IntensityQuantity quantity = IntensityQuantity::kUnknown;
  IntensityScale intensity_scale = IntensityScale::kUnknown;
  IntensityReference reference = IntensityReference::kUnknown;
  // intensity = sample * scale + offset; a scale of 0 states nothing.
  float scale = 0.0F;
  float offset = 0.0F;
  TvgModel tvg = TvgModel::kUnknown;
  float tvg_absorption_db_per_km = kUnknown;
  float source_level_db = kUnknown;
  std::uint8_t angular_normalization = 0;  // 0 unknown, 1 not applied, 2 applied
  // Mean response over the angle from nadir.
  std::vector<float> angular_response_angle_deg;
  std::vector<float> angular_response_db;
  std::uint8_t angular_response_loss = 0;  // its transmission loss: 0 unknown, 1 contained, 2 removed
  float angular_response_absorption_db_per_m = kUnknown;
  // Gain of transmission and reception over the angle.
  std::vector<float> beam_pattern_angle_deg;
  std::vector<float> beam_pattern_gain_db;
};

// True if both are equal except for their times.
bool HasSameContent(const SonarInfo& a, const SonarInfo& b);

inline constexpr const char* kSonarInfoType = "marine_interfaces/SonarInfo";

// Tries the three versions of the definition and accepts the one that ends with the message's last byte and
// has valid enumerations. Throws DataError, beginning with `where`, if none does or parallel arrays have
// different lengths.
SonarInfo ReadSonarInfo(std::span<const std::byte> bytes, MessageEncoding encoding, const std::string& where);

// Scale of an image with this scale in its message:
//
//   integers, decibel     db_min and db_max if absolute, otherwise db_span
//   floats, decibel       levels in dB
//   floats, amplitude     power, the square
//   anything else         unchanged
ImageScale ScaleWith(const SonarInfo& sonar, const ImageScale& scale);

// Converts the samples of an image, and its scale, to what the message says.
void Apply(const SonarInfo& sonar, PolarImage& image);

// Settings with those that the message states, for an image with this scale in its message.
SonarSettings SettingsWith(const SonarInfo& sonar, const ImageScale& scale, SonarSettings settings);

// Describes the sonar: name, scale, settings, source level, details and notes.
void Describe(const SonarInfo& sonar, RecordingInfo& info);

}  // namespace sonarcal::data_io
