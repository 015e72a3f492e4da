// Angles and levels. Stored angles are in radians if the name says `_rad`, in degrees if it says `_deg`.
// Levels are decibels of power.
#pragma once

#include <cmath>
#include <numbers>
#include <type_traits>

namespace sonarcal {

inline constexpr double kPi = std::numbers::pi;
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

// 10 log10(power). Requires power > 0.
template <typename T>
T DbFromPower(const T& power) {
  using std::log10;
  return T(10.0) * log10(power);
}

template <typename T>
T PowerFromDb(const T& level_db) {
  using std::exp;
  return exp(level_db * T(std::numbers::ln10 / 10.0));
}

}  // namespace sonarcal
