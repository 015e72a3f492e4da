// What the receiver makes of power: speckle, and the display.
//
// Speckle: power is Gamma-distributed about its mean with L looks (L = 1: exponential, standard deviation of
// its level 5.57 dB). Display, logarithmic: v = (10 log10 power - dB_min) / (dB_max - dB_min), clipped to [0,
// 1].
#pragma once

#include <cmath>
#include <numbers>
#include <unsupported/Eigen/SpecialFunctions>
#include <utility>

#include "data_io/types/parameters.h"
#include "data_io/types/units.h"

namespace sonarcal {

// E[10 log10 power] - 10 log10 E[power] = (10 / ln 10) (psi(L) - ln L), dB: -2.507 at one look. looks > 0.
inline double MeanLogSpeckleDb(double looks) {
  return 10.0 / std::numbers::ln10 * (Eigen::numext::digamma(looks) - std::log(looks));
}

// What the receiver adds to levels from range_m > 0.
inline double TimeVariedGainDb(TimeVariedGain law, double range_m, double absorption_db_per_m) {
  switch (law) {
    case TimeVariedGain::k20LogR:
      return 20.0 * std::log10(range_m);
    case TimeVariedGain::k40LogR:
      return 40.0 * std::log10(range_m);
    case TimeVariedGain::k40LogRAndAbsorption:
      return 40.0 * std::log10(range_m) + 2.0 * absorption_db_per_m * range_m;
    case TimeVariedGain::kNone:
      break;
  }
  return 0.0;
}

// The noise floor of a pixel; 0 where there is none.
inline double NoisePower(const ReceiverParameters& receiver, double range_m, int beam,
                         double absorption_db_per_m) {
  if (!receiver.noise_db) return 0.0;
  const double taper_db = receiver.noise_taper_db.empty() ? 0.0 : receiver.noise_taper_db[beam];
  return PowerFromDb(*receiver.noise_db + receiver.noise_slope_db_per_m * range_m + taper_db +
                     TimeVariedGainDb(receiver.time_varied_gain, range_m, absorption_db_per_m));
}

// Power below this (a dB figure far under any display) is shown as silence.
inline constexpr double kSilencePower = 1e-30;

// 0..1 unclipped.
template <typename T>
T LogDisplay(const DisplayParameters<T>& display, const T& level_db) {
  return (level_db - display.db_min) / (display.db_max - display.db_min);
}

// An average over whole looks and one more of weight w in [0, 1) that has the variance of L looks:
// (n + w)^2 / (n + w^2) = L with n = floor(L). Returns (n, w). looks >= 1.
inline std::pair<int, double> LooksAsWeights(double looks) {
  const int whole = static_cast<int>(std::floor(looks));
  const double n = whole;
  // (1 - L) w^2 + 2 n w + n^2 - L n = 0
  const double a = 1.0 - looks;
  const double c = n * n - looks * n;
  if (c == 0.0) return {whole, 0.0};
  const double root = std::sqrt(n * n - a * c);
  return {whole, (-n + root) / a};
}

}  // namespace sonarcal
