// How a sonar made the grey values of a frame, as far as its recording tells: what must be alike where frames
// are compared or fitted together. What is absent is unknown.
#pragma once

#include <optional>
#include <string>
#include <type_traits>

#include "core/types/words.h"

namespace sonarcal {

// How grey goes with the echo's level.
enum class Compression {
  kLogarithm,  // grey steps are decibels, softened at the lower end or not
  kPower,      // grey ~ amplitude^gamma; RecordingInfo::display_gamma, where known
};
constexpr auto WordsOf(std::type_identity<Compression>) {
  return Words<Compression, 2>{{{"logarithm", Compression::kLogarithm}, {"power", Compression::kPower}}};
}

struct SonarSettings {
  std::optional<double> gain_db;  // of the receiver
  std::optional<double> pulse_length_us;
  std::optional<bool> time_varied_gain;  // whether grey values contain one
  std::optional<Compression> compression;

  bool operator==(const SonarSettings&) const = default;
};

// "gain_db is 18 and 24", the first field that both tell and that is not the same (levels to 0.05 dB, pulses
// to 1 %); empty where there is none.
std::string SettingsMismatch(const SonarSettings& a, const SonarSettings& b);

// "gain 18 dB, pulse 15 us, time-varied gain unknown, compression logarithm".
std::string Describe(const SonarSettings& settings);

}  // namespace sonarcal
