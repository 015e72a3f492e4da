// Absorption and speed of sound in water.
//
// Absorption is in dB/m, one way. Two formulas:
//
//   Ainslie & McColm, J. Acoust. Soc. Am. 103(3), 1998, Eqs. 1-3 (Park 2024 Eq. (17); its Table 2 states
//     dB/m, but the result is in dB/km, and the depth is in kilometres).
//   Francois & Garrison, J. Acoust. Soc. Am. 72(6), 1982, Part II.
//
// Each is valid within the limits that its authors state (OutsideLimits). kAuto selects Ainslie-McColm if its
// limits hold, otherwise Francois-Garrison. Outside its limits a formula still returns a number, and
// AbsorptionCaveat returns a warning.
//
// To add a formula: a function, a value of AbsorptionFormula, its limits in OutsideLimits, a case in
// AbsorptionDbPerM, and a row of published values in tests/sim/physics/absorption_test.cc.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/types/sonar_model.h"
#include "core/types/words.h"

namespace sonarcal::sim {

enum class AbsorptionFormula { kAuto, kAinslieMcColm, kFrancoisGarrison };
constexpr auto WordsOf(std::type_identity<AbsorptionFormula>) {
  return Words<AbsorptionFormula, 3>{{{"auto", AbsorptionFormula::kAuto},
                                      {"ainslie-mccolm", AbsorptionFormula::kAinslieMcColm},
                                      {"francois-garrison", AbsorptionFormula::kFrancoisGarrison}}};
}

// frequency_hz > 0.
inline double AinslieMcColmDbPerM(double frequency_hz, const Water& water) {
  const double f = frequency_hz * 1e-3;  // kHz
  const double t = water.temperature_c;
  const double s = water.salinity_ppt;
  const double depth_km = water.depth_m * 1e-3;
  const double boric = 0.78 * std::sqrt(s / 35.0) * std::exp(t / 26.0);  // relaxation frequencies, kHz
  const double magnesium = 42.0 * std::exp(t / 17.0);
  const double db_per_km =
      0.106 * boric * f * f / (boric * boric + f * f) * std::exp((water.ph - 8.0) / 0.56) +
      0.52 * (1.0 + t / 43.0) * (s / 35.0) * magnesium * f * f / (magnesium * magnesium + f * f) *
          std::exp(-depth_km / 6.0) +
      0.00049 * f * f * std::exp(-(t / 27.0 + depth_km / 17.0));
  return db_per_km * 1e-3;
}

// frequency_hz > 0.
inline double FrancoisGarrisonDbPerM(double frequency_hz, const Water& water) {
  const double f = frequency_hz * 1e-3;  // kHz
  const double t = water.temperature_c;
  const double s = water.salinity_ppt;
  const double d = water.depth_m;
  const double c = 1412.0 + 3.21 * t + 1.19 * s + 0.0167 * d;
  const double kelvin = 273.0 + t;

  const double a1 = 8.86 / c * std::pow(10.0, 0.78 * water.ph - 5.0);
  const double f1 = 2.8 * std::sqrt(s / 35.0) * std::pow(10.0, 4.0 - 1245.0 / kelvin);

  const double a2 = 21.44 * (s / c) * (1.0 + 0.025 * t);
  const double p2 = 1.0 - 1.37e-4 * d + 6.2e-9 * d * d;
  const double f2 = 8.17 * std::pow(10.0, 8.0 - 1990.0 / kelvin) / (1.0 + 0.0018 * (s - 35.0));

  const double a3 = t <= 20.0 ? 4.937e-4 - 2.59e-5 * t + 9.11e-7 * t * t - 1.50e-8 * t * t * t
                              : 3.964e-4 - 1.146e-5 * t + 1.45e-7 * t * t - 6.5e-10 * t * t * t;
  const double p3 = 1.0 - 3.83e-5 * d + 4.9e-10 * d * d;

  const double db_per_km =
      a1 * f1 * f * f / (f1 * f1 + f * f) + a2 * p2 * f2 * f * f / (f2 * f2 + f * f) + a3 * p3 * f * f;
  return db_per_km * 1e-3;
}

// Values of frequency and water outside the limits that the formula's authors state, one phrase each. Empty
// if the formula is valid. `formula` must not be kAuto.
//
//   Ainslie-McColm                    100 Hz..1 MHz, -6..35 C, 5..50 ppt, pH 7.7..8.3, up to 7 km
//   Francois-Garrison, to 500 kHz     from 400 Hz, -1.8..30 C, 30..35 ppt, pH 7.7..8.3, up to 3.5 km
//                                     (magnesium sulphate or boric acid dominates)
//   Francois-Garrison, above 500 kHz  0..30 C, 0..40 ppt, up to 10 km, any pH (water dominates)
inline std::vector<std::string> OutsideLimits(AbsorptionFormula formula, double frequency_hz,
                                              const Water& water) {
  std::vector<std::string> outside;
  const auto check = [&](const char* name, double value, double low, double high, const char* unit) {
    if (value < low || value > high) {
      outside.push_back(fmt::format("{} {:g}{} (stated range {:g}..{:g})", name, value, unit, low, high));
    }
  };
  const double khz = frequency_hz * 1e-3;
  constexpr double kWaterDominatesKhz = 500.0;
  if (formula == AbsorptionFormula::kAinslieMcColm) {
    check("frequency", khz, 0.1, 1000.0, " kHz");
    check("temperature", water.temperature_c, -6.0, 35.0, " C");
    check("salinity", water.salinity_ppt, 5.0, 50.0, " ppt");
    check("pH", water.ph, 7.7, 8.3, "");
    check("depth", water.depth_m, 0.0, 7000.0, " m");
  } else if (khz > kWaterDominatesKhz) {
    check("temperature", water.temperature_c, 0.0, 30.0, " C");
    check("salinity", water.salinity_ppt, 0.0, 40.0, " ppt");
    check("depth", water.depth_m, 0.0, 10000.0, " m");
  } else {
    check("frequency", khz, 0.4, kWaterDominatesKhz, " kHz");
    check("temperature", water.temperature_c, -1.8, 30.0, " C");
    check("salinity", water.salinity_ppt, 30.0, 35.0, " ppt");
    check("pH", water.ph, 7.7, 8.3, "");
    check("depth", water.depth_m, 0.0, 3500.0, " m");
  }
  return outside;
}

// Formula in use: kAuto becomes Ainslie-McColm, the paper's, if its limits hold, otherwise Francois-Garrison.
inline AbsorptionFormula ResolvedAbsorption(AbsorptionFormula formula, double frequency_hz,
                                            const Water& water) {
  if (formula != AbsorptionFormula::kAuto) return formula;
  return OutsideLimits(AbsorptionFormula::kAinslieMcColm, frequency_hz, water).empty()
             ? AbsorptionFormula::kAinslieMcColm
             : AbsorptionFormula::kFrancoisGarrison;
}

inline double AbsorptionDbPerM(AbsorptionFormula formula, double frequency_hz, const Water& water) {
  return ResolvedAbsorption(formula, frequency_hz, water) == AbsorptionFormula::kAinslieMcColm
             ? AinslieMcColmDbPerM(frequency_hz, water)
             : FrancoisGarrisonDbPerM(frequency_hz, water);
}

inline std::string_view NameOf(AbsorptionFormula formula) {
  return formula == AbsorptionFormula::kAinslieMcColm ? "Ainslie-McColm" : "Francois-Garrison";
}

// Message if the formula in use is outside its stated limits: the values outside, and the results of both
// formulas. A warning if neither formula is valid, a note if the other one is. Empty if the formula in use is
// valid.
inline std::string AbsorptionCaveat(AbsorptionFormula formula, double frequency_hz, const Water& water) {
  const AbsorptionFormula used = ResolvedAbsorption(formula, frequency_hz, water);
  const std::vector<std::string> outside = OutsideLimits(used, frequency_hz, water);
  if (outside.empty()) return {};
  const AbsorptionFormula other = used == AbsorptionFormula::kAinslieMcColm
                                      ? AbsorptionFormula::kFrancoisGarrison
                                      : AbsorptionFormula::kAinslieMcColm;
  const bool other_holds = OutsideLimits(other, frequency_hz, water).empty();
  return fmt::format(
      "{}absorption by {} ({:.4f} dB/m) is used outside its stated range: {}; {} gives {:.4f} dB/m{}",
      other_holds ? "" : "warning: ", NameOf(used), AbsorptionDbPerM(used, frequency_hz, water),
      fmt::join(outside, ", "), NameOf(other), AbsorptionDbPerM(other, frequency_hz, water),
      other_holds ? ", and its range holds" : ", outside its range too");
}

// Sentence with formula and value, and the reason if the paper's formula is not used.
inline std::string AbsorptionStatement(AbsorptionFormula formula, double frequency_hz, const Water& water) {
  const AbsorptionFormula used = ResolvedAbsorption(formula, frequency_hz, water);
  std::string text = fmt::format("Absorption by {}: {:.4f} dB/m one way.", NameOf(used),
                                 AbsorptionDbPerM(used, frequency_hz, water));
  if (used == AbsorptionFormula::kAinslieMcColm) return text;
  const std::vector<std::string> outside =
      OutsideLimits(AbsorptionFormula::kAinslieMcColm, frequency_hz, water);
  return text + fmt::format(" The paper's formula, Ainslie-McColm, gives {:.4f} dB/m{}{}.",
                            AinslieMcColmDbPerM(frequency_hz, water),
                            outside.empty() ? "" : " outside its stated range: ", fmt::join(outside, ", "));
}

// Speed of sound in sea water, m/s. Mackenzie, J. Acoust. Soc. Am. 70(3), 1981. Valid 2..30 C, 25..40 ppt,
// 0..8000 m.
inline double MackenzieSoundSpeed(double temperature_c, double salinity_ppt, double depth_m) {
  const double t = temperature_c;
  const double s = salinity_ppt - 35.0;
  const double d = depth_m;
  return 1448.96 + 4.591 * t - 5.304e-2 * t * t + 2.374e-4 * t * t * t + 1.340 * s + 1.630e-2 * d +
         1.675e-7 * d * d - 1.025e-2 * t * s - 7.139e-13 * t * d * d * d;
}

// Speed of sound in pure water at atmospheric pressure, m/s. Bilaniuk & Wong, J. Acoust. Soc. Am. 93(3),
// 1993, 148-point fit. Valid 0..100 C.
inline double BilaniukWongSoundSpeed(double temperature_c) {
  constexpr double kHighestPowerFirst[] = {3.16585020e-9,  -1.48259672e-6, 3.34638117e-4,
                                           -5.81172916e-2, 5.03836171,     1.40238744e3};
  double speed = 0.0;
  for (const double coefficient : kHighestPowerFirst) speed = speed * temperature_c + coefficient;
  return speed;
}

}  // namespace sonarcal::sim
