// Settings with which a sonar made the grey values of a frame, as far as the recording contains them. They
// must agree between frames that are compared or fitted together. Absent values are unknown.
#pragma once

#include <optional>
#include <string>
#include <type_traits>

#include "core/types/words.h"

namespace sonarcal {

// Relation between grey value and echo level.
enum class Compression {
  kLogarithm,  // grey steps are decibels; the lower end may be softened
  kPower,      // grey ~ amplitude^gamma; RecordingInfo::display_gamma, if known
};
constexpr auto WordsOf(std::type_identity<Compression>) {
  return Words<Compression, 2>{{{"logarithm", Compression::kLogarithm}, {"power", Compression::kPower}}};
}

struct SonarSettings {
  std::optional<double> gain_db;  // of the receiver
  std::optional<double> pulse_length_us;
  std::optional<bool> time_varied_gain;  // true if grey values contain time-varying gain
  std::optional<Compression> compression;

  bool operator==(const SonarSettings&) const = default;
};

// Text such as "gain_db is 18 and 24" for the first field that both contain and that differs (levels by more
// than 0.05 dB, pulses by more than 1 %). Empty if there is none.
std::string SettingsMismatch(const SonarSettings& a, const SonarSettings& b);

// Text such as "gain 18 dB, pulse 15 us, time-varied gain unknown, compression logarithm".
std::string Describe(const SonarSettings& settings);

}  // namespace sonarcal
