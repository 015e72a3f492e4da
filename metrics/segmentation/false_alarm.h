// False-alarm probabilities: the probability that a background cell looks like an object, for the tests of
// metrics/segmentation/cfar.h and metrics/segmentation/likelihood_ratio.h. All are given in decades, -log10
// of the probability, at most kMaxDecades. A threshold of d decades is a false-alarm rate of 10^-d.
//
// Background: the power of a pixel has a Gamma distribution with shape `looks`, independent between pixels.
// The mean of n pixels then has a Gamma distribution with shape n looks.
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace sonarcal::metrics {

inline constexpr double kMaxDecades = 300.0;

// P(x > ratio) of a Gamma variable of mean 1 and shape `looks` > 0. 0 decades for ratio <= 0.
double GammaTailDecades(double looks, double ratio);

// Cell-averaging CFAR: P(cell > ratio x mean of the training cells). The cell has `cell_looks` and the mean
// `training_looks` looks, independently: the tail of an F distribution with twice as many degrees of freedom
// each. For one look each and N training cells: (1 + ratio / N)^-N (Finn & Johnson 1968).
double CellAveragingDecades(double cell_looks, double training_looks, double ratio);

// Decades as a function of a ratio, for many pixels. Tabulated over ratios e^-8..e^8 in steps of e^0.02 and
// interpolated; relative error 1e-4 plus 1e-3 decades. Constant beyond the ends.
class DecadesTable {
 public:
  explicit DecadesTable(const std::function<double(double ratio)>& decades);

  double operator()(double ratio) const;

 private:
  std::vector<double> decades_;
};

// Ordered-statistic CFAR (Rohling 1983): P(cell > ratio x the rank-th smallest of `count` training cells).
// The cell has `cell_looks` looks, training cells have `looks` looks each. For one look each: product over i
// < rank of (count - i) / (count - i + ratio). Otherwise a tabulated quadrature over the distribution of the
// rank-th smallest, with an error below 1e-3 decades.
class OrderedStatisticLaw {
 public:
  // 1 <= rank <= count.
  OrderedStatisticLaw(double cell_looks, double looks, int count, int rank);

  double Decades(double ratio) const;

 private:
  double ByQuadrature(double ratio) const;

  double cell_looks_;
  int count_;
  int rank_;
  bool closed_form_;
  // Nodes of the distribution of the rank-th smallest: values, and weights with sum 1.
  std::vector<double> value_;
  std::vector<double> weight_;
  std::optional<DecadesTable> table_;
};

// CFAR for grey levels of a logarithmic display of unknown slope. The excess over the background, in units of
// the background's own spread, has a distribution that does not depend on slope and offset. Both classes
// assume many training cells (100 or more); with few, false alarms are more frequent than stated.
//
//   LogMeanLaw      excess over the mean, in standard deviations (Goldstein 1973)
//   LogQuantileLaw  excess over the quantile `upper`, in distances between quantiles `lower` and `upper`
//
// Cell and training cells have `looks` looks each.
class LogMeanLaw {
 public:
  explicit LogMeanLaw(double looks);

  double Decades(double excess) const;

 private:
  double mean_log_;
  double spread_log_;
  DecadesTable tail_;
};

class LogQuantileLaw {
 public:
  // 0 < lower < upper < 1.
  LogQuantileLaw(double looks, double lower, double upper);

  double Decades(double excess) const;

 private:
  double upper_log_;
  double distance_log_;
  DecadesTable tail_;
};

// Quantile of a Gamma variable of mean 1 and shape `looks` at probability `chance`, 0..1 exclusive.
double GammaQuantile(double looks, double chance);

}  // namespace sonarcal::metrics
