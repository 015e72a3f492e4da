// Speckle and its effect on the display.
//
// Speckle: the power of a pixel is P x with E[x] = 1. Four distributions of x, all of variance 1 / L:
//
//   kGamma     Gamma with shape L: an average of L equal looks, L > 0 (L = 1: exponential)
//   kWeighted  Average of unequal looks with the weights of `LooksAsWeights`, as in `SampleAcousticImage`.
//              Closed form for 1 <= L <= 2:
//              F(x) = 1 - (exp(-y) - w exp(-y / w)) / (1 - w), y = (1 + w) x; Gamma beyond.
//   kK         Reverberation with texture: the K law of k_law.h for L < 1; Gamma from L = 1 on.
//   kKDiffuse  Texture and a diffuse component: the law of k_diffuse_law.h for L < 1; Gamma from L = 1 on.
//              The functions below do not know it, because it has a second parameter.
//
// Display: v increases with power, so P(displayed <= v) = F(PowerFromDisplay(v) / P). The mean displayed
// value, clipped to 0..1, is the integral of 1 - P(displayed <= v) over 0..1.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <unsupported/Eigen/SpecialFunctions>
#include <vector>

#include "core/types/error.h"
#include "core/types/units.h"
#include "core/types/words.h"
#include "sim/physics/display.h"
#include "sim/physics/k_law.h"
#include "sim/physics/receiver.h"

namespace sonarcal::sim {

enum class SpeckleLaw { kGamma, kWeighted, kK, kKDiffuse };
constexpr auto WordsOf(std::type_identity<SpeckleLaw>) {
  return Words<SpeckleLaw, 4>{{{"gamma", SpeckleLaw::kGamma},
                               {"weighted", SpeckleLaw::kWeighted},
                               {"k", SpeckleLaw::kK},
                               {"k_diffuse", SpeckleLaw::kKDiffuse}}};
}

// The functions of `looks` alone do not know the law with a second parameter.
inline void CheckIsOfLooksAlone(SpeckleLaw law) {
  SONARCAL_CHECK(law != SpeckleLaw::kKDiffuse, "a law of looks and diffuse share: use KDiffuseLaw");
}

// From here on a ratio counts as infinite, so that its products with the looks stay finite.
inline constexpr double kEndOfRatios = 1e300;

// Returns the weight w of the second look in the closed form of kWeighted. The first look has the weight 1.
// Absent for other laws, for 2 looks or more, and for nearly equal weights: then the law is Gamma.
inline std::optional<double> SecondWeight(SpeckleLaw law, double looks) {
  if (law != SpeckleLaw::kWeighted || looks >= 2.0) return std::nullopt;
  constexpr double kNearlyOne = 1.0 - 1e-6;
  const double w = LooksAsWeights(looks).second;
  return w < kNearlyOne ? std::optional(w) : std::nullopt;
}

// P(x <= ratio); 0 for ratio <= 0. looks > 0 (kWeighted: >= 1; kK: >= kLeastTexturedLooks).
inline double SpeckleCdf(double looks, double ratio, SpeckleLaw law = SpeckleLaw::kGamma) {
  CheckIsOfLooksAlone(law);
  if (!(ratio > 0.0)) return 0.0;
  if (!(ratio < kEndOfRatios)) return 1.0;
  if (looks == 1.0) return -std::expm1(-ratio);
  if (law == SpeckleLaw::kK && looks < 1.0) return std::clamp(1.0 - KLawSurvival(looks, ratio), 0.0, 1.0);
  if (const std::optional<double> w = SecondWeight(law, looks)) {
    const double y = (1.0 + *w) * ratio;
    return std::max(0.0, (-std::expm1(-y) + *w * std::expm1(-y / *w)) / (1.0 - *w));
  }
  return Eigen::numext::igamma(looks, looks * ratio);
}

// P(x > ratio), to full relative accuracy, where 1 - SpeckleCdf has lost its digits.
inline double SpeckleSurvival(double looks, double ratio, SpeckleLaw law = SpeckleLaw::kGamma) {
  CheckIsOfLooksAlone(law);
  if (!(ratio > 0.0)) return 1.0;
  if (!(ratio < kEndOfRatios)) return 0.0;
  if (looks == 1.0) return std::exp(-ratio);
  if (law == SpeckleLaw::kK && looks < 1.0) return KLawSurvival(looks, ratio);
  if (const std::optional<double> w = SecondWeight(law, looks)) {
    const double y = (1.0 + *w) * ratio;
    return (std::exp(-y) - *w * std::exp(-y / *w)) / (1.0 - *w);
  }
  return Eigen::numext::igammac(looks, looks * ratio);
}

// Density of x: the derivative of SpeckleCdf. 0 for ratio <= 0.
inline double SpeckleDensity(double looks, double ratio, SpeckleLaw law = SpeckleLaw::kGamma) {
  CheckIsOfLooksAlone(law);
  if (!(ratio > 0.0) || !(ratio < kEndOfRatios)) return 0.0;
  if (looks == 1.0) return std::exp(-ratio);
  if (law == SpeckleLaw::kK && looks < 1.0) return KLawDensity(looks, ratio);
  if (const std::optional<double> w = SecondWeight(law, looks)) {
    const double y = (1.0 + *w) * ratio;
    return (1.0 + *w) * (std::exp(-y) - std::exp(-y / *w)) / (1.0 - *w);
  }
  return std::exp(looks * std::log(looks * ratio) - looks * ratio - Eigen::numext::lgamma(looks)) / ratio;
}

// P(displayed <= v) at mean power `power` > 0, before clipping. At v = 0 it is the share clipped to 0; at v =
// 1 its complement is the share clipped to full scale.
inline double DisplayedCdf(const DisplayParameters<double>& display, double looks, double power, double value,
                           SpeckleLaw law = SpeckleLaw::kGamma) {
  return SpeckleCdf(looks, PowerFromDisplay(display, value) / power, law);
}

// Mean of the displayed value, clipped to 0..1 and not rounded: black, and a midpoint rule over the values
// above it. The laws other than kLog are steep at black, so the steps are short there:
// value = black + (1 - black) t^3.
class MeanRule {
 public:
  static constexpr int kSteps = 1024;  // error of the mean below 1e-5, for up to 9 looks

  explicit MeanRule(const DisplayParameters<double>& display, int steps = kSteps)
      : black_(std::clamp(DisplayValue(display, 0.0), 0.0, 1.0)) {
    const bool is_log = display.law == DisplayLaw::kLog;
    for (int k = 0; k < steps; ++k) {
      const double t = (k + 0.5) / steps;
      power_.push_back(PowerFromDisplay(display, black_ + (1.0 - black_) * (is_log ? t : t * t * t)));
      weight_.push_back((1.0 - black_) * (is_log ? 1.0 : 3.0 * t * t) / steps);
    }
  }

  // Steps that leave an error below 2e-6. kLog: (span / steps)^2 / 24 times the largest slope of the
  // survival over level, at most 0.092 sqrt(looks) per dB, over the span. Other laws may be steeper: kSteps.
  static int StepsFor(const DisplayParameters<double>& display, double looks) {
    constexpr double kError = 2e-6;
    if (display.law != DisplayLaw::kLog) return kSteps;
    const double span_db = display.db_max - display.db_min;
    const double step_db = std::sqrt(24.0 * kError * span_db / (0.092 * std::sqrt(std::max(looks, 1.0))));
    return std::clamp(static_cast<int>(std::ceil(span_db / step_db)), 32, kSteps);
  }

  double operator()(double looks, double power, SpeckleLaw law = SpeckleLaw::kGamma) const {
    double mean = black_;
    for (std::size_t k = 0; k < power_.size(); ++k)
      mean += weight_[k] * (1.0 - SpeckleCdf(looks, power_[k] / power, law));
    return mean;
  }

 private:
  double black_;                // value of silence
  std::vector<double> power_;   // at the midpoint of each step
  std::vector<double> weight_;  // change of the value over each step
};

// MeanRule for many pixels: tabulated by level, every 0.1 dB, and interpolated. For displays of 20 dB or
// more, it differs from the rule by less than 2e-5 with 1 to 2 looks, and by less than 6e-5 with up to 9.
class MeanDisplayTable {
 public:
  MeanDisplayTable(const DisplayParameters<double>& display, double looks,
                   SpeckleLaw law = SpeckleLaw::kGamma)
      : display_(display) {
    // Range of levels in which the mean varies: from 40 dB below db_min, and from 20 dB below the darkest
    // level that is not black, to 50 dB above db_max. The soft laws show levels far below soft_db. A power
    // law displays a thousandth of full scale at 60 dB / exponent below it.
    if (display.law == DisplayLaw::kPower) {
      low_db_ = display.db_max - 80.0 / display.exponent;
    } else {
      constexpr double kJustAboveBlack = 1e-5;
      const double dark = std::max(DisplayValue(display, 0.0), 0.0) + kJustAboveBlack;
      const double dark_power = std::max(PowerFromDisplay(display, dark), kSilencePower);
      low_db_ = std::min(display.db_min - 40.0, DbFromPower(dark_power) - 20.0);
    }
    low_db_ = std::max(low_db_, DbFromPower(kSilencePower));  // lower levels are not looked up
    const int count = static_cast<int>(std::ceil((display.db_max + 50.0 - low_db_) / kStepDb)) + 1;
    const MeanRule rule(display, MeanRule::StepsFor(display, looks));
    for (int i = 0; i < count; ++i) mean_.push_back(rule(looks, PowerFromDb(low_db_ + i * kStepDb), law));
  }

  double operator()(double power) const {
    const double level_db = DbFromPower(std::max(power, kSilencePower));
    const double position = (level_db - low_db_) / kStepDb;
    if (position <= 0.0) {
      return display_.law == DisplayLaw::kPower
                 ? mean_.front() * PowerFromDb(0.5 * display_.exponent * (level_db - low_db_))
                 : mean_.front();
    }
    // Before the conversion, because power may be infinite.
    if (!(position < static_cast<double>(mean_.size() - 1))) return mean_.back();
    const auto i = static_cast<std::size_t>(position);
    const double fraction = position - static_cast<double>(i);
    return (1.0 - fraction) * mean_[i] + fraction * mean_[i + 1];
  }

 private:
  static constexpr double kStepDb = 0.1;

  DisplayParameters<double> display_;
  double low_db_ = 0.0;
  std::vector<double> mean_;
};

}  // namespace sonarcal::sim
