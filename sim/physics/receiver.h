// Effects of the receiver on echoes: time-varying gain, a noise floor in power, and the number of looks per
// pixel. speckle.h: speckle through the display. display.h: the display itself.
#pragma once

#include <cmath>
#include <unsupported/Eigen/SpecialFunctions>
#include <utility>
#include <vector>

#include "core/types/error.h"
#include "core/types/image.h"
#include "core/types/parameters.h"
#include "core/types/units.h"
#include "sim/physics/display.h"

namespace sonarcal::sim {

// Gain of the law at range_m > 0, dB. Without absorption it is 0 dB at 1 m.
inline double TimeVariedGainDb(TimeVariedGain law, double range_m, double absorption_db_per_m) {
  const double range_db = 10.0 * std::log10(range_m);
  switch (law) {
    case TimeVariedGain::kNone:
      return 0.0;
    case TimeVariedGain::k20LogR:
      return 2.0 * range_db;
    case TimeVariedGain::k40LogR:
      return 4.0 * range_db;
    case TimeVariedGain::k40LogRAndAbsorption:
      return 4.0 * range_db + 2.0 * absorption_db_per_m * range_m;
  }
  SONARCAL_CHECK(false, "time-varied gain {}", static_cast<int>(law));
  return 0.0;
}

// Throws DataError if a taper does not have one value per beam.
inline void CheckTapers(const ReceiverParameters& receiver, int beams) {
  const auto check = [beams](const std::vector<double>& taper, const char* name) {
    if (!taper.empty() && static_cast<int>(taper.size()) != beams) {
      throw DataError("receiver.{} has {} values, expected one for each of {} beams", name, taper.size(),
                      beams);
    }
  };
  check(receiver.noise_taper_db, "noise_taper_db");
  check(receiver.noise_after_gain_taper_db, "noise_after_gain_taper_db");
}

// N(r, b) of core/types/parameters.h; 0 if neither floor is given. The tapers must fit the beams
// (CheckTapers).
inline double NoisePower(const ReceiverParameters& receiver, double range_m, int beam,
                         double absorption_db_per_m) {
  const auto taper_db = [beam](const std::vector<double>& taper) {
    return taper.empty() ? 0.0 : taper[beam];
  };
  double power = 0.0;
  if (receiver.noise_db) {
    power += PowerFromDb(*receiver.noise_db + receiver.noise_slope_db_per_m * range_m +
                         taper_db(receiver.noise_taper_db) +
                         TimeVariedGainDb(receiver.time_varied_gain, range_m, absorption_db_per_m));
  }
  if (receiver.noise_after_gain_db) {
    power += PowerFromDb(*receiver.noise_after_gain_db + taper_db(receiver.noise_after_gain_taper_db));
  }
  return power;
}

// NoisePower of every bin and beam at low cost: both floors are products of one factor per bin and one per
// beam.
class ReceiverNoise {
 public:
  ReceiverNoise(const ReceiverParameters& receiver, const PolarAxes& axes, double absorption_db_per_m) {
    CheckTapers(receiver, axes.beam_count());
    ReceiverParameters before = receiver;
    before.noise_taper_db.clear();
    before.noise_after_gain_db.reset();
    for (int bin = 0; bin < axes.range_bins; ++bin) {
      before_gain_by_bin_.push_back(NoisePower(before, axes.range_centre_m(bin), 0, absorption_db_per_m));
    }
    ReceiverParameters after = receiver;
    after.noise_db.reset();
    constexpr double kAnyRangeM = 1.0;
    for (int beam = 0; beam < axes.beam_count(); ++beam) {
      taper_.push_back(receiver.noise_taper_db.empty() ? 1.0 : PowerFromDb(receiver.noise_taper_db[beam]));
      after_gain_.push_back(NoisePower(after, kAnyRangeM, beam, absorption_db_per_m));
    }
  }

  // Noise floor before time-varying gain, with the gain applied: noise_db, its trend and taper.
  double BeforeGain(int bin, int beam) const { return before_gain_by_bin_[bin] * taper_[beam]; }
  double Power(int bin, int beam) const { return BeforeGain(bin, beam) + after_gain_[beam]; }

 private:
  std::vector<double> before_gain_by_bin_;
  std::vector<double> taper_;
  std::vector<double> after_gain_;
};

// E[10 log10 power] - 10 log10 E[power] = (10 / ln 10) (psi(L) - ln L), dB: -2.507 at one look. looks > 0.
inline double MeanLogSpeckleDb(double looks) {
  return kDbPerNeper * (Eigen::numext::digamma(looks) - std::log(looks));
}

// Throws DataError for a number of looks of which no speckled image can be drawn.
inline void CheckLooksToDraw(double looks) {
  if (!(looks >= 1.0)) {
    throw DataError(
        "receiver.looks {}: a speckled image needs at least one look, and texture (fewer looks) is not "
        "simulated",
        looks);
  }
}

// Weights of an average of floor(L) looks and one more of weight w in [0, 1) that has the variance of L
// looks: (n + w)^2 / (n + w^2) = L with n = floor(L). Returns (n, w). looks >= 1.
inline std::pair<int, double> LooksAsWeights(double looks) {
  const int whole = static_cast<int>(std::floor(looks));
  const double n = whole;
  // Solves (1 - L) w^2 + 2 n w - c = 0 without a difference of nearly equal numbers.
  const double c = looks * n - n * n;
  return {whole, c / (n + std::sqrt(n * n + (1.0 - looks) * c))};
}

}  // namespace sonarcal::sim
