// Angles and levels. Stored angles are in radians if the name says `_rad`, in degrees if it says `_deg`.
// Levels are decibels of power.
#pragma once

#include <cmath>
#include <numbers>
#include <type_traits>

namespace sonarcal {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * kPi;
inline constexpr double kDegPerRad = 180.0 / kPi;
inline constexpr double kRadPerDeg = kPi / 180.0;

template <typename T>
constexpr T DegFromRad(const T& angle_rad) {
  static_assert(!std::is_integral_v<T>, "whole numbers would truncate the result");
  return angle_rad * T(kDegPerRad);
}

template <typename T>
constexpr T RadFromDeg(const T& angle_deg) {
  static_assert(!std::is_integral_v<T>, "whole numbers would truncate the result");
  return angle_deg * T(kRadPerDeg);
}

// Decibels of power in nepers of power (the unit of a natural logarithm), and back.
inline constexpr double kNeperPerDb = std::numbers::ln10 / 10.0;
inline constexpr double kDbPerNeper = 10.0 / std::numbers::ln10;

// 10 log10(power). Requires power > 0.
template <typename T>
T DbFromPower(const T& power) {
  using std::log;
  return log(power) * T(kDbPerNeper);
}

// 10^(level_db / 10).
template <typename T>
T PowerFromDb(const T& level_db) {
  using std::exp;
  return exp(level_db * T(kNeperPerDb));
}

// 10^(level_db / 20): the amplitude of a level of power.
template <typename T>
T AmplitudeFromDb(const T& level_db) {
  return PowerFromDb(T(T(0.5) * level_db));
}

}  // namespace sonarcal
