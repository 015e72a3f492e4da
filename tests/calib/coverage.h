// Whether a fit's sigmas are true: many SYNTHETIC data sets from the acoustic model itself, each fitted, and
// the estimates held against the truth.
//
// The truth stays; of each data set speckle is drawn anew, and so is what was known beforehand: the initial
// values, which are the priors' centres, are drawn about the truth as the priors say (a factor of ten in an
// amplitude, of e in a width, ...). Then error and sigma of a parameter speak of the same thing even where
// the prior has a say. The scene (tests/calib/small_tank.h) is traced once.
//
// All figures are of the coordinate that a fit moves (the logarithm of amplitudes and widths); an interval is
// the estimate +- 1 or 1.96 sigma there.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calib/fit.h"
#include "calib/models/acoustic_frame_model.h"

namespace sonarcal::testing {

enum class Speckle {
  kIndependent,  // every pixel on its own, Gamma about the mean power: what the likelihood supposes
  kGrained,      // Simulator's draw: coherent through beam and pulse, pixels a grain apart are alike
};

// Start of each fit. The priors are centred on it.
enum class Start {
  kAboutTruth,  // drawn about the truth as the priors say
  kReadme,      // the same curve for every material, as `reproduce` writes it for README's fit
};

struct CoverageOptions {
  Start start = Start::kAboutTruth;
  bool tank_curves = false;  // the true curves are those of reproduce's floor and mock-up
  Speckle speckle = Speckle::kIndependent;
  int data_sets = 200;
  std::uint64_t seed = 1;
  double beam_width_deg = 1.0;  // the beams' spacing is 0.6 degrees
  double pulse_bins = 1.0;
  int views = 3;               // of each of eight sides: that many times eight frames
  double prior_scatter = 0.3;  // of the initial values about the truth, in prior sigmas
  calib::FitOptions fit;
  std::function<void(int)> progress;  // told how many data sets are done
};

// Of one parameter, over the data sets in which it counted as determined.
struct CoverageRow {
  std::string name;
  int determined = 0;           // data sets in which the fit gave it a sigma
  double truth = 0.0;           // value, in its unit
  double bias_in_sigmas = 0.0;  // mean error over mean sigma
  double spread = 0.0;          // standard deviation of the error
  double mean_sigma = 0.0;      // root of the mean square
  double bound = 0.0;           // Cramer-Rao, of independent pixels and the priors
  double prior_share = 0.0;     // of the bound's variance in the prior's
  double covered_68 = 0.0;      // share of data sets
  double covered_95 = 0.0;
  // Variance over that of the linear estimate truth + I^-1 score from the same data, whose expectation is the
  // bound exactly where pixels are independent: chance cancels.
  double variance_over_linear = 0.0;
};

// Share of all parameters that an interval covers, mean over data sets. The errors of one data set are
// correlated, so its standard error is that of a mean of data sets.
struct CoveredShare {
  double mean = 0.0;
  double standard_error = 0.0;
};

struct CoverageTable {
  std::vector<CoverageRow> rows = {};  // every free parameter
  CoveredShare all_68 = {};
  CoveredShare all_95 = {};
  int data_sets = 0;
  int failed = 0;  // fits without a usable solution
  // Share of the curves' values, every degree of 5 .. 80, within their own 95 % band.
  double curves_covered_95 = 0.0;
  // Mean of error^T bound^-1 error / parameters, over all free parameters; 1 for an efficient estimate.
  double variance_over_bound = 0.0;
};

CoverageTable StudyCoverage(const CoverageOptions& options);

// Rows as a Markdown table.
std::string Markdown(const CoverageTable& table);

}  // namespace sonarcal::testing
