// Likelihood of recorded grey values under a noise law. The probability of a grey level is that of its
// quantisation interval under speckle through the display. Level 0 stands for all values there or below, full
// scale for all above (Tobit at both clips).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calib/fit_report.h"
#include "calib/noise/noise_histogram.h"
#include "calib/noise/quantile_residual.h"
#include "core/types/parameters.h"
#include "sim/physics/k_diffuse_law.h"
#include "sim/physics/speckle.h"

namespace sonarcal::calib {

// Result of a noise fit.
struct NoiseLaw {
  DisplayParameters<double> display;
  ReceiverParameters receiver;
  sim::SpeckleLaw speckle = sim::SpeckleLaw::kGamma;
};

// Probabilities of the grey levels and their derivatives by the parameters of the law.
class GreyLevels {
 public:
  // `by_looks`: computes the derivative by ln looks, which costs as much as all others; otherwise it is 0,
  // except for the law with a diffuse component.
  GreyLevels(const NoiseLaw& law, int full_scale, bool by_looks = true);

  // Derivatives by ln N, ln looks, display span (dB, with db_min fixed), soft_db, logit of the diffuse share.
  static constexpr int kDerivatives = 5;
  struct Chance {
    double value = 0.0;
    double beyond = 1.0;  // for Below: 1 - value, with all its digits
    std::array<double, kDerivatives> derivative = {};
  };

  // P(grey <= level) at noise power N: level -1 gives 0, full_scale gives 1.
  double Cdf(int level, double noise_power) const;
  // Cumulative probability with its derivatives. OfLevel is the difference of two.
  Chance Below(int level, double noise_power) const;
  static Chance Between(const Chance& lower, const Chance& upper);
  // As Below, without derivatives.
  QuantileBound Bound(int level, double noise_power) const;
  Chance OfLevel(int level, double noise_power) const {
    return Between(Below(level - 1, noise_power), Below(level, noise_power));
  }

 private:
  double RatioAt(int level, double noise_power) const { return edge_power_[level] / noise_power; }
  QuantileBound BoundAt(double ratio) const;
  // The law at one ratio of power to its mean.
  sim::KDiffuseLaw::Value SpeckleAt(double ratio) const;

  NoiseLaw law_;
  sim::SpeckleLaw closed_form_;  // without with_diffuse_
  std::optional<sim::KDiffuseLaw> with_diffuse_;
  bool by_looks_ = true;
  std::vector<double> edge_power_;    // upper edge of each level except the last
  std::vector<double> edge_by_span_;  // its derivatives
  std::vector<double> edge_by_soft_db_;
};

// Agreement of a law with a block of 8 bins x 8 beams.
struct NoiseBlock {
  int first_bin = 0;
  int end_bin = 0;  // one past the last
  int first_beam = 0;
  int end_beam = 0;
  double pixels = 0.0;
  double ks = 0.0;
  double recorded_mean = 0.0;  // grey
  double predicted_mean = 0.0;
};

// Agreement of a law with counts. Leaves out cells of weight 0.
struct NoiseAgreement {
  double nats_per_pixel = 0.0;    // -log likelihood
  double ks = 0.0;                // largest difference of the cumulative distributions
  double wasserstein_grey = 0.0;  // mean shift between the distributions, grey levels
  double cell_ks_median = 0.0;    // as `ks`, per cell of 8 bins x 8 beams
  double cell_ks_p95 = 0.0;
  double pixels = 0.0;
  std::vector<NoiseBlock> blocks;  // with pixels, by range, then by beam
  ResidualSummary raw;             // per pixel: grey minus the predicted mean, full scale 1
  ResidualSummary whitened;  // per pixel: calib/noise/quantile_residual.h; mean 0 and spread 1 for a true law
  std::vector<double> recorded;  // share of each grey level
  std::vector<double> predicted;
  Grid<float> recorded_mean;  // bands x beams, grey; NaN where left out
  Grid<float> predicted_mean;
  Grid<float> whitened_mean;  // mean of the whitened residuals
};

inline constexpr int kJudgeBins = 8;
inline constexpr int kJudgeBeams = 8;

// `weight`: per cell of `cells`, 0 or 1; empty: all 1.
NoiseAgreement Agreement(const NoiseLaw& law, const NoiseCounts& counts, const NoiseCells& cells,
                         const std::vector<double>& weight, double absorption_db_per_m);

}  // namespace sonarcal::calib
