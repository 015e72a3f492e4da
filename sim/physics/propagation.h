// Spreading, absorption and the active sonar equation (Park 2024 Eqs. 10-18).
#pragma once

#include <cmath>

namespace sonarcal::sim {

// TL = 20 log10(R) + alpha R, one way, dB re 1 m. range_m > 0.
template <typename T>
T TransmissionLossDb(const T& range_m, double absorption_db_per_m) {
  using std::log10;
  return T(20.0) * log10(range_m) + T(absorption_db_per_m) * range_m;
}

// SNR = SL - 2 TL + TS - NL + AG. The paper's simplified form, Eq. (11), has NL = AG = 0.
template <typename T>
T SonarEquationDb(const T& source_level_db, const T& two_way_loss_db, const T& target_strength_db,
                  double noise_level_db = 0.0, double array_gain_db = 0.0) {
  return source_level_db - two_way_loss_db + target_strength_db - T(noise_level_db) + T(array_gain_db);
}

}  // namespace sonarcal::sim
