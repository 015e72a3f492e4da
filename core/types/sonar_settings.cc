#include "core/types/sonar_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sonarcal {
namespace {

const char* Word(bool applied) {
  return applied ? "applied" : "not applied";
}

const char* Word(Compression compression) {
  return compression == Compression::kLogarithm ? "logarithm" : "power";
}

}  // namespace

std::string SettingsMismatch(const SonarSettings& a, const SonarSettings& b) {
  constexpr double kSameDb = 0.05;
  constexpr double kSamePulse = 0.01;
  if (a.compression && b.compression && *a.compression != *b.compression)
    return fmt::format("compression is {} and {}", Word(*a.compression), Word(*b.compression));
  if (a.time_varied_gain && b.time_varied_gain && *a.time_varied_gain != *b.time_varied_gain)
    return fmt::format("time_varied_gain is {} and {}", Word(*a.time_varied_gain), Word(*b.time_varied_gain));
  if (a.gain_db && b.gain_db && std::abs(*a.gain_db - *b.gain_db) > kSameDb)
    return fmt::format("gain_db is {:g} and {:g}", *a.gain_db, *b.gain_db);
  if (a.pulse_length_us && b.pulse_length_us &&
      std::abs(*a.pulse_length_us - *b.pulse_length_us) >
          kSamePulse * std::max(*a.pulse_length_us, *b.pulse_length_us))
    return fmt::format("pulse_length_us is {:g} and {:g}", *a.pulse_length_us, *b.pulse_length_us);
  return {};
}

std::string Describe(const SonarSettings& settings) {
  const auto number = [](const std::optional<double>& value, const char* unit) {
    return value ? fmt::format("{:g} {}", *value, unit) : std::string("unknown");
  };
  return fmt::format("gain {}, pulse {}, time-varied gain {}, compression {}", number(settings.gain_db, "dB"),
                     number(settings.pulse_length_us, "us"),
                     settings.time_varied_gain ? Word(*settings.time_varied_gain) : "unknown",
                     settings.compression ? Word(*settings.compression) : "unknown");
}

}  // namespace sonarcal
