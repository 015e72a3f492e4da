#include "calib/noise/noise_fit_report.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

namespace sonarcal::calib {
namespace {

// A parameter is unidentifiable if its variance exceeds this share of the prior variance (half of the
// standard deviation). A level is also unidentifiable if its standard error exceeds kMaxSigmaDb.
constexpr double kMaxPriorShare = 0.25;
constexpr double kMaxSigmaDb = 20.0;
// Level and trend of the floor are not determined separately if the variance of the level in the middle of
// the window is below this share of its variance at range 0.
constexpr double kMaxShareAtMiddle = 0.25;
constexpr double kTogether = 0.9;  // a correlation above which two parameters are determined only together

class Builder {
 public:
  Builder(const NoiseSolution& solution, const Eigen::MatrixXd& covariance)
      : solution_(solution),
        covariance_(covariance),
        posterior_(solution.information.ldlt().solve(
            Eigen::MatrixXd::Identity(solution.layout.count, solution.layout.count))) {}

  void Add(const std::string& name, const std::string& unit, int place, double value, double initial,
           double lower, double upper, double unit_a_step = 1.0) {
    FittedParameter parameter{.name = name,
                              .unit = unit,
                              .value = value,
                              .sigma = {},
                              .initial = initial,
                              .lower = lower,
                              .upper = upper,
                              .status = ParameterStatus::kFixed};
    if (place >= 0) {
      parameter.status = ParameterStatus::kFree;
      if ((place == solution_.layout.log_looks && solution_.looks_at_bound) ||
          (place == solution_.layout.logit_diffuse && solution_.diffuse_at_bound)) {
        parameter.status = ParameterStatus::kAtBound;
      } else if (!IsDetermined(place, unit)) {
        parameter.status = ParameterStatus::kUnidentifiable;
        undetermined_.push_back({name, unit, place});
      } else {
        parameter.sigma = unit_a_step * std::sqrt(StatedVariance(place));
        if (!IsTaper(place)) determined_.push_back({name, unit, place});
      }
    }
    report_.parameters.push_back(parameter);
  }

  // Reports correlations of the determined parameters, except tapers.
  FitReport Finish(const NoiseCells& cells) {
    const int count = static_cast<int>(determined_.size());
    report_.correlation = Eigen::MatrixXd::Identity(count, count);
    for (int row = 0; row < count; ++row) {
      report_.correlation_names.push_back(determined_[row].name);
      for (int col = 0; col < row; ++col) {
        report_.correlation(row, col) = Correlation(determined_[row].place, determined_[col].place);
        report_.correlation(col, row) = report_.correlation(row, col);
      }
    }
    DescribeFloor(cells);
    DescribeTapers(solution_.layout.taper, "receiver.noise_taper_db");
    DescribeTapers(solution_.layout.after_taper, "receiver.noise_after_gain_taper_db");
    for (const Parameter& parameter : undetermined_) {
      if (!IsTaper(parameter.place)) Describe(parameter);
    }
    return std::move(report_);
  }

 private:
  struct Parameter {
    std::string name;
    std::string unit;
    int place = -1;
  };

  // Larger of the variances by sandwich and by curvature, because each misses some uncertainty.
  double Variance(int place) const { return std::max(covariance_(place, place), posterior_(place, place)); }

  // The sandwich, which needs pings that differ. Of equal ones, as of a repeated still, the curvature.
  double StatedVariance(int place) const {
    constexpr double kMinShare = 1e-3;  // a thirtieth of the standard error that the curvature gives
    const double curvature = posterior_(place, place);
    return covariance_(place, place) > kMinShare * curvature ? covariance_(place, place) : curvature;
  }

  bool IsDetermined(int place, const std::string& unit) const {
    const double variance = Variance(place);
    const double most = kMaxPriorShare / solution_.prior_precision[place];
    return variance <= (unit == "dB" ? std::min(most, kMaxSigmaDb * kMaxSigmaDb) : most);
  }

  // Returns true if the result is the prior: the pings have no information.
  bool IsAssumed(int place) const {
    return posterior_(place, place) * solution_.prior_precision[place] > kMaxPriorShare;
  }

  bool IsTaper(int place) const {
    const NoiseLayout& layout = solution_.layout;
    const auto within = [&](int first) {
      return first >= 0 && place >= first && place < first + layout.beams;
    };
    return within(layout.taper) || within(layout.after_taper);
  }

  double Correlation(int i, int j) const {
    return covariance_(i, j) / std::sqrt(covariance_(i, i) * covariance_(j, j));
  }

  // In a short or distant window, level at range 0 and trend of the floor before the gain are determined only
  // together. The pings determine the level in the window.
  void DescribeFloor(const NoiseCells& cells) {
    const NoiseLayout& layout = solution_.layout;
    const auto is_floor = [&](const Parameter& parameter) {
      return parameter.place == layout.noise_db || parameter.place == layout.slope;
    };
    if (layout.noise_db < 0 || std::none_of(undetermined_.begin(), undetermined_.end(), is_floor)) return;
    Eigen::VectorXd at_middle = Eigen::VectorXd::Zero(layout.count);
    const double near_m = cells.axes.range_edge_m(cells.first_bin);
    const double far_m = cells.axes.range_edge_m(cells.last_bin);
    at_middle[layout.noise_db] = 1.0;
    at_middle[layout.slope] = 0.5 * (near_m + far_m);
    const double variance =
        std::max(at_middle.dot(covariance_ * at_middle), at_middle.dot(posterior_ * at_middle));
    if (!(variance <= kMaxShareAtMiddle * Variance(layout.noise_db) && variance <= kMaxSigmaDb * kMaxSigmaDb))
      return;
    report_.unidentifiable_directions.push_back(fmt::format(
        "receiver.noise_db and receiver.noise_slope_db_per_m are not determined separately: only the noise "
        "level over the fitted ranges, {:.2f} to {:.2f} m, is known, at their middle to {:.2g} dB",
        near_m, far_m, std::sqrt(variance)));
    std::erase_if(undetermined_, is_floor);
  }

  void DescribeTapers(int first, const std::string& name) {
    if (first < 0) return;
    std::string beams;
    int count = 0;
    for (const Parameter& parameter : undetermined_) {
      const int beam = parameter.place - first;
      if (beam < 0 || beam >= solution_.layout.beams) continue;
      if (++count <= kBeamsNamed) beams += fmt::format("{}{}", beams.empty() ? "" : ", ", beam);
    }
    if (count == 0) return;
    if (count > kBeamsNamed) beams += " and others";
    report_.unidentifiable_directions.push_back(
        fmt::format("{} of {} of {} beams ({}) is hardly determined by the pings: it stays near its prior, "
                    "the mean of all beams",
                    name, count, solution_.layout.beams, beams));
  }

  void Describe(const Parameter& parameter) {
    std::string text =
        IsAssumed(parameter.place)
            ? fmt::format("the pings hardly determine {}: its value comes from the prior", parameter.name)
            : fmt::format("{} is known to no better than {:.2g}{}{}", parameter.name,
                          std::sqrt(Variance(parameter.place)), parameter.unit.empty() ? "" : " ",
                          parameter.unit);
    for (const std::vector<Parameter>* list : {&determined_, &undetermined_}) {
      for (const Parameter& other : *list) {
        if (other.place == parameter.place || IsTaper(other.place)) continue;
        if (std::abs(Correlation(parameter.place, other.place)) < kTogether) continue;
        text += fmt::format(", and moves together with {}", other.name);
      }
    }
    report_.unidentifiable_directions.push_back(text);
  }

  static constexpr int kBeamsNamed = 8;

  const NoiseSolution& solution_;
  const Eigen::MatrixXd& covariance_;
  Eigen::MatrixXd posterior_;
  FitReport report_;
  std::vector<Parameter> determined_;  // except tapers
  std::vector<Parameter> undetermined_;
};

std::vector<std::string> GaugeOf(const NoiseLaw& law, bool fit_span) {
  std::vector<std::string> gauge = {
      "Levels are relative: display.db_min is fixed, and the pings determine the distance of the noise from "
      "it.",
      "Tapers have a mean of 0 dB over the beams; the floors' levels carry the rest."};
  if (law.display.law == DisplayLaw::kPower) {
    gauge.emplace_back(
        "The exponent is fixed: background alone determines only one number for exponent and looks.");
    gauge[0] =
        "Levels are relative: display.db_max is fixed, and the pings determine the distance of the noise "
        "from it.";
  } else if (fit_span) {
    gauge.emplace_back(
        "receiver.looks is fixed at 1 and the display's span is fitted, because the recording does not state "
        "it: background alone determines only one number for the two.");
  } else {
    gauge.emplace_back(
        "The display's span is fixed and receiver.looks is fitted: background alone determines only one "
        "number for the two.");
  }
  return gauge;
}

}  // namespace

FitReport NoiseReport(const NoiseSolution& solution, const NoiseLaw& start, const Eigen::MatrixXd& covariance,
                      bool fit_span, int frames_used, const NoiseCells& cells) {
  const NoiseLayout& layout = solution.layout;
  const NoiseLaw& law = solution.law;
  Builder builder(solution, covariance);
  builder.Add("display.db_min", "dB", -1, law.display.db_min, start.display.db_min, -kMaxLevelDb,
              kMaxLevelDb);
  builder.Add("display.db_max", "dB", layout.span_db, law.display.db_max, start.display.db_max,
              law.display.db_min + kLeastSpanDb, law.display.db_min + kMaxSpanDb);
  if (law.display.law == DisplayLaw::kSoftLog || law.display.law == DisplayLaw::kSoftAmplitude) {
    builder.Add("display.soft_db", "dB", layout.soft_db, law.display.soft_db, start.display.soft_db,
                -kMaxLevelDb, kMaxLevelDb);
  }
  if (law.display.law == DisplayLaw::kPower) {
    builder.Add("display.exponent", "", -1, law.display.exponent, start.display.exponent, 0.0, 10.0);
  }
  builder.Add("receiver.looks", "", layout.log_looks, law.receiver.looks, start.receiver.looks,
              MinNoiseLooks(law.speckle), kMaxNoiseLooks, law.receiver.looks);
  if (layout.logit_diffuse >= 0) {
    const double share = law.receiver.diffuse_share;
    builder.Add("receiver.diffuse_share", "", layout.logit_diffuse, share, start.receiver.diffuse_share,
                kMinDiffuseShare, kMaxDiffuseShare, share * (1.0 - share));
  }
  if (layout.noise_db >= 0) {
    builder.Add("receiver.noise_db", "dB", layout.noise_db, *law.receiver.noise_db,
                start.receiver.noise_db.value_or(0.0), -kMaxLevelDb, kMaxLevelDb);
    builder.Add("receiver.noise_slope_db_per_m", "dB/m", layout.slope, law.receiver.noise_slope_db_per_m,
                start.receiver.noise_slope_db_per_m, -kMaxSlopeDbPerM, kMaxSlopeDbPerM);
  }
  if (layout.after_db >= 0) {
    builder.Add("receiver.noise_after_gain_db", "dB", layout.after_db, *law.receiver.noise_after_gain_db,
                start.receiver.noise_after_gain_db.value_or(0.0), -kMaxLevelDb, kMaxLevelDb);
  }
  for (int beam = 0; beam < layout.beams; ++beam) {
    if (layout.taper >= 0) {
      builder.Add(fmt::format("receiver.noise_taper_db.{}", beam), "dB", layout.taper + beam,
                  law.receiver.noise_taper_db[beam], 0.0, -kMaxLevelDb, kMaxLevelDb);
    }
  }
  for (int beam = 0; beam < layout.beams; ++beam) {
    if (layout.after_taper >= 0) {
      builder.Add(fmt::format("receiver.noise_after_gain_taper_db.{}", beam), "dB", layout.after_taper + beam,
                  law.receiver.noise_after_gain_taper_db[beam], 0.0, -kMaxLevelDb, kMaxLevelDb);
    }
  }
  FitReport report = builder.Finish(cells);
  report.gauge = GaugeOf(law, fit_span);
  report.cost_initial = solution.cost_initial;
  report.cost_final = solution.cost;
  report.iterations = solution.iterations;
  report.termination = solution.converged ? "converged" : "ended before it converged";
  if (frames_used < 5) {
    report.gauge.emplace_back(
        "Fewer than five pings: the standard errors treat range bands as independent and do not include "
        "drift from ping to ping.");
  }
  return report;
}

}  // namespace sonarcal::calib
