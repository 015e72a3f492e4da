#include "metrics/segmentation/false_alarm.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/SpecialFunctions>

#include "core/math/bisection.h"
#include "core/types/error.h"

namespace sonarcal::metrics {
namespace {

// std::lgamma writes a global variable, and these laws are computed in several threads at the same time.
using Eigen::numext::lgamma;

// Range of DecadesTable.
constexpr double kLowestLog = -8.0;
constexpr double kHighestLog = 8.0;
constexpr int kTableSteps = 800;

double DecadesOf(double chance) {
  // Small probabilities underflow; the result is limited to kMaxDecades.
  return chance > 0.0 ? std::clamp(-std::log10(chance), 0.0, kMaxDecades) : kMaxDecades;
}

double NepersToDecades(double nepers) {
  return std::clamp(nepers / std::numbers::ln10, 0.0, kMaxDecades);
}

}  // namespace

double GammaTailDecades(double looks, double ratio) {
  if (!(ratio > 0.0)) return 0.0;
  if (looks == 1.0) return NepersToDecades(ratio);
  return DecadesOf(Eigen::numext::igammac(looks, looks * std::min(ratio, 1e12)));
}

double CellAveragingDecades(double cell_looks, double training_looks, double ratio) {
  if (!(ratio > 0.0)) return 0.0;
  if (cell_looks == 1.0) return NepersToDecades(training_looks * std::log1p(ratio / training_looks));
  const double share = training_looks / (training_looks + cell_looks * ratio);
  return DecadesOf(Eigen::numext::betainc(training_looks, cell_looks, share));
}

DecadesTable::DecadesTable(const std::function<double(double ratio)>& decades) {
  for (int step = 0; step <= kTableSteps; ++step) {
    decades_.push_back(decades(std::exp(kLowestLog + (kHighestLog - kLowestLog) * step / kTableSteps)));
  }
}

double DecadesTable::operator()(double ratio) const {
  if (!(ratio > 0.0)) return 0.0;
  const double position = (std::log(ratio) - kLowestLog) / (kHighestLog - kLowestLog) * kTableSteps;
  if (position <= 0.0) return decades_.front();
  if (position >= kTableSteps) return decades_.back();
  const auto step = static_cast<std::size_t>(position);
  const double fraction = position - static_cast<double>(step);
  return (1.0 - fraction) * decades_[step] + fraction * decades_[step + 1];
}

double GammaQuantile(double looks, double chance) {
  SONARCAL_CHECK(chance > 0.0 && chance < 1.0, "quantile of chance {}", chance);
  if (looks == 1.0) return -std::log1p(-chance);
  constexpr double kMinLog = -60.0;
  constexpr double kMaxLog = 10.0;
  return std::exp(Bisection(kMinLog, kMaxLog, [&](double log_ratio) {
    return Eigen::numext::igamma(looks, looks * std::exp(log_ratio)) < chance;
  }));
}

OrderedStatisticLaw::OrderedStatisticLaw(double cell_looks, double looks, int count, int rank)
    : cell_looks_(cell_looks), count_(count), rank_(rank), closed_form_(cell_looks == 1.0 && looks == 1.0) {
  SONARCAL_CHECK(rank >= 1 && rank <= count, "rank {} of {}", rank, count);
  if (closed_form_) return;
  // The probability below the rank-th smallest value has the distribution Beta(rank, count - rank + 1).
  constexpr int kNodes = 200;
  const double a = rank;
  const double b = count - rank + 1;
  const double mean = a / (a + b);
  const double spread = std::sqrt(mean * (1.0 - mean) / (a + b + 1.0));
  const double low = std::max(0.0, mean - 9.0 * spread);
  const double high = std::min(1.0, mean + 9.0 * spread);
  double total = 0.0;
  for (int i = 0; i < kNodes; ++i) {
    const double share = low + (high - low) * (i + 0.5) / kNodes;
    const double density = std::exp((a - 1.0) * std::log(share) + (b - 1.0) * std::log1p(-share) +
                                    lgamma(a + b) - lgamma(a) - lgamma(b));
    if (!(density > 0.0)) continue;
    value_.push_back(GammaQuantile(looks, share));
    weight_.push_back(density);
    total += density;
  }
  for (double& weight : weight_) weight /= total;
  table_.emplace([this](double ratio) { return ByQuadrature(ratio); });
}

double OrderedStatisticLaw::ByQuadrature(double ratio) const {
  double chance = 0.0;
  for (std::size_t i = 0; i < value_.size(); ++i) {
    chance += weight_[i] * Eigen::numext::igammac(cell_looks_, cell_looks_ * ratio * value_[i]);
  }
  return DecadesOf(chance);
}

double OrderedStatisticLaw::Decades(double ratio) const {
  if (!(ratio > 0.0)) return 0.0;
  if (closed_form_) {
    // Product of (count - i) / (count - i + ratio), by Gamma functions.
    const double n = count_;
    const double k = rank_;
    return NepersToDecades(lgamma(n + ratio + 1.0) - lgamma(n - k + ratio + 1.0) - lgamma(n + 1.0) +
                           lgamma(n - k + 1.0));
  }
  return (*table_)(ratio);
}

LogMeanLaw::LogMeanLaw(double looks)
    : mean_log_(Eigen::numext::digamma(looks) - std::log(looks)),
      spread_log_(std::sqrt(Eigen::numext::zeta(2.0, looks))),  // trigamma function
      tail_([looks](double ratio) { return GammaTailDecades(looks, ratio); }) {}

double LogMeanLaw::Decades(double excess) const {
  return tail_(std::exp(mean_log_ + excess * spread_log_));
}

LogQuantileLaw::LogQuantileLaw(double looks, double lower, double upper)
    : upper_log_(std::log(GammaQuantile(looks, upper))),
      distance_log_(upper_log_ - std::log(GammaQuantile(looks, lower))),
      tail_([looks](double ratio) { return GammaTailDecades(looks, ratio); }) {
  SONARCAL_CHECK(lower < upper, "quantiles {} and {}", lower, upper);
}

double LogQuantileLaw::Decades(double excess) const {
  return tail_(std::exp(upper_log_ + excess * distance_log_));
}

}  // namespace sonarcal::metrics
