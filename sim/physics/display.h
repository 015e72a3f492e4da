// Display laws: received power to grey value v, in units of full scale before clipping, and back
// (core/types/parameters.h: DisplayLaw).
//
//   kLog      v = (10 log10 P - db_min) / (db_max - db_min)                            ARIS
//   kSoftLog  v = (10 log10(P + 10^(soft_db / 10)) - db_min) / (db_max - db_min)       DIDSON
//   kSoftAmplitude
//             v = (20 log10(sqrt(P) + 10^(soft_db / 20)) - db_min) / (db_max - db_min) ARIS 3000
//   kPower    v = (P / 10^(db_max / 10))^(exponent / 2)                                Oculus
//
// v increases monotonically with P. To add a law: a word in core/types/parameters.h, its keys in
// data_io/parameters/parameters_io.cc, a case in each function here.
#pragma once

#include <cmath>

#include "core/types/error.h"
#include "core/types/image.h"
#include "core/types/parameters.h"
#include "core/types/units.h"

namespace sonarcal::sim {

// Scale of an image of grey levels by a display.
inline ImageScale GreyScale(const DisplayParameters<double>& display, double full_scale) {
  return {.quantity = Quantity::kGrey,
          .full_scale = full_scale,
          .db_min = display.db_min,
          .db_max = display.db_max,
          .db_span = {}};
}

// Lower limit of power, far below any display.
inline constexpr double kSilencePower = 1e-30;

// Display value of a level by the law kLog. Shown values are 0..1; not clipped.
template <typename T>
T LogDisplay(const DisplayParameters<T>& display, const T& level_db) {
  return (level_db - display.db_min) / (display.db_max - display.db_min);
}

// Display value of power >= 0. Power below kSilencePower counts as kSilencePower.
template <typename T>
T DisplayValue(const DisplayParameters<T>& display, const T& power) {
  using std::exp;
  using std::log;
  const T audible = power < T(kSilencePower) ? T(kSilencePower) : power;
  switch (display.law) {
    case DisplayLaw::kLog:
      return LogDisplay(display, DbFromPower(audible));
    case DisplayLaw::kSoftLog:
      return LogDisplay(display, DbFromPower(T(audible + T(PowerFromDb(display.soft_db)))));
    case DisplayLaw::kSoftAmplitude: {
      using std::sqrt;
      return LogDisplay(display,
                        T(T(2.0) * DbFromPower(T(sqrt(audible) + AmplitudeFromDb(display.soft_db)))));
    }
    case DisplayLaw::kPower:
      return exp(T(0.5 * display.exponent) * (log(audible) - display.db_max * T(kNeperPerDb)));
  }
  SONARCAL_CHECK(false, "display law {}", static_cast<int>(display.law));
  return T(0.0);
}

// Power that is displayed as v: the inverse of DisplayValue. 0 if no power is displayed as low as v: both
// soft laws at or below v = (soft_db - db_min) / (db_max - db_min), kPower at or below 0.
template <typename T>
T PowerFromDisplay(const DisplayParameters<T>& display, const T& value) {
  using std::exp;
  using std::log;
  switch (display.law) {
    case DisplayLaw::kLog:
      return PowerFromDb(T(display.db_min + value * (display.db_max - display.db_min)));
    case DisplayLaw::kSoftLog: {
      const T softened = PowerFromDb(T(display.db_min + value * (display.db_max - display.db_min)));
      const T power = softened - T(PowerFromDb(display.soft_db));
      return power > T(0.0) ? power : T(0.0);
    }
    case DisplayLaw::kSoftAmplitude: {
      const T softened = AmplitudeFromDb(T(display.db_min + value * (display.db_max - display.db_min)));
      const T amplitude = softened - T(AmplitudeFromDb(display.soft_db));
      return amplitude > T(0.0) ? T(amplitude * amplitude) : T(0.0);
    }
    case DisplayLaw::kPower:
      if (!(value > T(0.0))) return T(0.0);
      return exp(log(value) * T(2.0 / display.exponent)) * PowerFromDb(display.db_max);
  }
  SONARCAL_CHECK(false, "display law {}", static_cast<int>(display.law));
  return T(0.0);
}

// dv / dP at power > 0.
inline double DisplaySlope(const DisplayParameters<double>& display, double power) {
  const double per_db = 1.0 / (display.db_max - display.db_min);
  switch (display.law) {
    case DisplayLaw::kLog:
      return per_db * kDbPerNeper / power;
    case DisplayLaw::kSoftLog:
      return per_db * kDbPerNeper / (power + PowerFromDb(display.soft_db));
    case DisplayLaw::kSoftAmplitude: {
      const double amplitude = std::sqrt(power);
      return per_db * kDbPerNeper / (amplitude * (amplitude + AmplitudeFromDb(display.soft_db)));
    }
    case DisplayLaw::kPower:
      return 0.5 * display.exponent * DisplayValue(display, power) / power;
  }
  SONARCAL_CHECK(false, "display law {}", static_cast<int>(display.law));
  return 0.0;
}

}  // namespace sonarcal::sim
