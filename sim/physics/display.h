// Display laws: how received power becomes a grey value v, in parts of full scale and before clipping, and
// back again (types/parameters.h: DisplayLaw).
//
//   kLog      v = (10 log10 P - db_min) / (db_max - db_min)                            ARIS
//   kSoftLog  v = (10 log10(P + 10^(soft_db / 10)) - db_min) / (db_max - db_min)       DIDSON
//   kSoftAmplitude
//             v = (20 log10(sqrt(P) + 10^(soft_db / 20)) - db_min) / (db_max - db_min) ARIS 3000
//   kPower    v = (P / 10^(db_max / 10))^(exponent / 2)                                Oculus
//
// v rises with P everywhere. To add a law: a word in types/parameters.h and
// data_io/parameters/parameters_io.cc, a case in each function here.
#pragma once

#include <cmath>
#include <numbers>

#include "core/types/error.h"
#include "core/types/parameters.h"

namespace sonarcal::sim {

// Power below this (a dB figure far under any display) is shown as silence.
inline constexpr double kSilencePower = 1e-30;

// The kLog law of a level. 0..1 unclipped.
template <typename T>
T LogDisplay(const DisplayParameters<T>& display, const T& level_db) {
  return (level_db - display.db_min) / (display.db_max - display.db_min);
}

template <typename T>
T PowerOfLevel(const T& level_db) {
  using std::exp;
  return exp(level_db * T(std::numbers::ln10 / 10.0));
}

inline double AmplitudeOfLevel(double level_db) {
  return PowerOfLevel(0.5 * level_db);
}

template <typename T>
T LevelOfPower(const T& power) {
  using std::log;
  return log(power) * T(10.0 / std::numbers::ln10);
}

// v of power >= 0. Power below kSilencePower counts as that.
template <typename T>
T DisplayValue(const DisplayParameters<T>& display, const T& power) {
  using std::exp;
  using std::log;
  const T audible = power < T(kSilencePower) ? T(kSilencePower) : power;
  switch (display.law) {
    case DisplayLaw::kLog:
      return LogDisplay(display, LevelOfPower(audible));
    case DisplayLaw::kSoftLog:
      return LogDisplay(display, LevelOfPower(T(audible + T(PowerOfLevel(display.soft_db)))));
    case DisplayLaw::kSoftAmplitude: {
      using std::sqrt;
      return LogDisplay(display,
                        T(T(2.0) * LevelOfPower(T(sqrt(audible) + AmplitudeOfLevel(display.soft_db)))));
    }
    case DisplayLaw::kPower:
      return exp(T(0.5 * display.exponent) * (log(audible) - display.db_max * T(std::numbers::ln10 / 10.0)));
  }
  SONARCAL_CHECK(false, "display law {}", static_cast<int>(display.law));
  return T(0.0);
}

// The power shown as v: the inverse of DisplayValue. 0 where no power is shown that low: at or below the soft
// floor v = (soft_db - db_min) / (db_max - db_min) of both soft laws, and at or below 0 of kPower.
template <typename T>
T PowerFromDisplay(const DisplayParameters<T>& display, const T& value) {
  using std::exp;
  using std::log;
  switch (display.law) {
    case DisplayLaw::kLog:
      return PowerOfLevel(T(display.db_min + value * (display.db_max - display.db_min)));
    case DisplayLaw::kSoftLog: {
      const T softened = PowerOfLevel(T(display.db_min + value * (display.db_max - display.db_min)));
      const T power = softened - T(PowerOfLevel(display.soft_db));
      return power > T(0.0) ? power : T(0.0);
    }
    case DisplayLaw::kSoftAmplitude: {
      const T softened = PowerOfLevel(T(0.5 * (display.db_min + value * (display.db_max - display.db_min))));
      const T amplitude = softened - T(AmplitudeOfLevel(display.soft_db));
      return amplitude > T(0.0) ? T(amplitude * amplitude) : T(0.0);
    }
    case DisplayLaw::kPower:
      if (!(value > T(0.0))) return T(0.0);
      return exp(log(value) * T(2.0 / display.exponent)) * PowerOfLevel(display.db_max);
  }
  SONARCAL_CHECK(false, "display law {}", static_cast<int>(display.law));
  return T(0.0);
}

// dv / dP at power > 0.
inline double DisplaySlope(const DisplayParameters<double>& display, double power) {
  const double per_db = 1.0 / (display.db_max - display.db_min);
  switch (display.law) {
    case DisplayLaw::kLog:
      return per_db * 10.0 / std::numbers::ln10 / power;
    case DisplayLaw::kSoftLog:
      return per_db * 10.0 / std::numbers::ln10 / (power + PowerOfLevel(display.soft_db));
    case DisplayLaw::kSoftAmplitude: {
      const double amplitude = std::sqrt(power);
      return per_db * 10.0 / std::numbers::ln10 /
             (amplitude * (amplitude + AmplitudeOfLevel(display.soft_db)));
    }
    case DisplayLaw::kPower:
      return 0.5 * display.exponent * DisplayValue(display, power) / power;
  }
  SONARCAL_CHECK(false, "display law {}", static_cast<int>(display.law));
  return 0.0;
}

}  // namespace sonarcal::sim
