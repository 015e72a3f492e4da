// Chances that a cell of nothing but background looks like an object, for the tests of
// metrics/segmentation/cfar.h and metrics/segmentation/likelihood_ratio.h. All are given as decades, -log10
// of the chance, at most kMostDecades: what a threshold is set on, since a threshold of d decades is a
// false-alarm rate of 10^-d.
//
// Background: the power of a pixel is Gamma distributed with shape `looks`, pixels independent. The mean of n
// pixels is then Gamma distributed with shape n looks.
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace sonarcal::metrics {

inline constexpr double kMostDecades = 300.0;

// Mean 1, shape `looks` > 0: P(x > ratio). 0 decades for a ratio of 0 or less.
double GammaTailDecades(double looks, double ratio);

// Cell-averaging CFAR: P(cell > ratio x mean of the training cells), the cell with `cell_looks`, that mean
// with `training_looks` looks, independent: the tail of an F distribution with twice as many degrees of
// freedom each. One look each, N training cells: (1 + ratio / N)^-N (Finn & Johnson 1968).
double CellAveragingDecades(double cell_looks, double training_looks, double ratio);

// Decades as a function of a ratio, tabulated over ratios of e^-8..e^8, every e^0.02, and interpolated:
// within 1e-4 of the decades there + 1e-3. Beyond, the value at the end. For many pixels.
class DecadesTable {
 public:
  explicit DecadesTable(const std::function<double(double ratio)>& decades);

  double operator()(double ratio) const;

 private:
  std::vector<double> decades_;
};

// Ordered-statistic CFAR (Rohling 1983): P(cell > ratio x the rank-th smallest of `count` training cells),
// the cell with `cell_looks`, training cells with `looks` looks each. One look each: product over i < rank of
// (count - i) / (count - i + ratio). Otherwise by quadrature over the law of the rank-th smallest, tabulated:
// within 1e-3 decades.
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
  // Of the rank-th smallest: values and their weights, which add up to 1.
  std::vector<double> value_;
  std::vector<double> weight_;
  std::optional<DecadesTable> table_;
};

// The same for grey levels of a logarithmic display of unknown slope: there the excess over the background,
// in units of the background's own spread, has a law free of slope and offset. Both are as of many training
// cells (100 or more): with few, false alarms are more frequent than stated.
//   LogMeanLaw      excess over the mean, in standard deviations (Goldstein 1973)
//   LogQuantileLaw  excess over the quantile `upper`, in distances between quantiles `lower` and `upper`
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

// The ratio below which a share `chance`, 0..1 exclusive, of a Gamma variable of mean 1 and shape `looks`
// lies.
double GammaQuantile(double looks, double chance);

}  // namespace sonarcal::metrics
