#include "calib/noise_fit_report.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

namespace sonarcal {
namespace {

// Told less about than this, in variance, the data say nothing of their own.
constexpr double kUntold = 0.25;

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
      if (posterior_(place, place) * solution_.prior_precision[place] > kUntold) {
        parameter.status = ParameterStatus::kUnidentifiable;
        untold_.push_back(name);
      } else if (place == solution_.layout.log_looks && solution_.looks_at_bound) {
        parameter.status = ParameterStatus::kAtBound;
      } else {
        parameter.sigma = unit_a_step * std::sqrt(covariance_(place, place));
      }
    }
    report_.parameters.push_back(parameter);
  }

  // The level of one beam follows the tapers' list; correlations are told of the others.
  FitReport Finish(const std::vector<std::pair<std::string, int>>& correlated) {
    const int count = static_cast<int>(correlated.size());
    report_.correlation = Eigen::MatrixXd::Identity(count, count);
    for (int row = 0; row < count; ++row) {
      report_.correlation_names.push_back(correlated[row].first);
      for (int col = 0; col < count; ++col) {
        const int i = correlated[row].second;
        const int j = correlated[col].second;
        report_.correlation(row, col) = covariance_(i, j) / std::sqrt(covariance_(i, i) * covariance_(j, j));
      }
    }
    if (!untold_.empty()) {
      report_.unidentifiable_directions.push_back(
          fmt::format("the pings say next to nothing about {} of the parameters, {} the first: each stands "
                      "where what was assumed beforehand puts it",
                      untold_.size(), untold_.front()));
    }
    return std::move(report_);
  }

 private:
  const NoiseSolution& solution_;
  const Eigen::MatrixXd& covariance_;
  Eigen::MatrixXd posterior_;
  FitReport report_;
  std::vector<std::string> untold_;
};

std::vector<std::string> GaugeOf(const NoiseLaw& law, bool fit_span) {
  std::vector<std::string> gauge = {
      "Levels are relative: display.db_min is fixed, and what is told is how far the noise lies from it.",
      "Tapers have a mean of 0 dB over the beams; the floors' levels carry the rest."};
  if (law.display.law == DisplayLaw::kPower) {
    gauge.emplace_back("The exponent is fixed: on background alone it and the looks are one number.");
    gauge[0] =
        "Levels are relative: display.db_max is fixed, and what is told is how far the noise lies from it.";
  } else if (fit_span) {
    gauge.emplace_back(
        "receiver.looks is fixed at 1 and the display's span is fitted, as the recording does not tell it: "
        "on "
        "background alone the two are one number.");
  } else {
    gauge.emplace_back(
        "The display's span is fixed and receiver.looks is fitted: on background alone the two are one "
        "number.");
  }
  return gauge;
}

}  // namespace

FitReport NoiseReport(const NoiseSolution& solution, const NoiseLaw& start, const Eigen::MatrixXd& covariance,
                      bool fit_span, int frames_used) {
  const NoiseLayout& layout = solution.layout;
  const NoiseLaw& law = solution.law;
  Builder builder(solution, covariance);
  std::vector<std::pair<std::string, int>> correlated;
  const auto correlate = [&](const std::string& name, int place) {
    if (place >= 0) correlated.emplace_back(name, place);
  };
  builder.Add("display.db_min", "dB", -1, law.display.db_min, start.display.db_min, -500.0, 500.0);
  builder.Add("display.db_max", "dB", layout.span_db, law.display.db_max, start.display.db_max,
              law.display.db_min + 5.0, law.display.db_min + 400.0);
  correlate("display.db_max", layout.span_db);
  if (layout.soft_db >= 0) {
    builder.Add("display.soft_db", "dB", layout.soft_db, law.display.soft_db, start.display.soft_db, -500.0,
                500.0);
    correlate("display.soft_db", layout.soft_db);
  }
  if (law.display.law == DisplayLaw::kPower) {
    builder.Add("display.exponent", "", -1, law.display.exponent, start.display.exponent, 0.0, 10.0);
  }
  builder.Add("receiver.looks", "", layout.log_looks, law.receiver.looks, start.receiver.looks, kFewestLooks,
              kMostLooks, law.receiver.looks);
  if (!solution.looks_at_bound) correlate("receiver.looks", layout.log_looks);
  if (layout.noise_db >= 0) {
    builder.Add("receiver.noise_db", "dB", layout.noise_db, *law.receiver.noise_db,
                start.receiver.noise_db.value_or(0.0), -500.0, 500.0);
    builder.Add("receiver.noise_slope_db_per_m", "dB/m", layout.slope, law.receiver.noise_slope_db_per_m,
                start.receiver.noise_slope_db_per_m, -1000.0, 1000.0);
    correlate("receiver.noise_db", layout.noise_db);
    correlate("receiver.noise_slope_db_per_m", layout.slope);
  }
  if (layout.after_db >= 0) {
    builder.Add("receiver.noise_after_gain_db", "dB", layout.after_db, *law.receiver.noise_after_gain_db,
                start.receiver.noise_after_gain_db.value_or(0.0), -500.0, 500.0);
    correlate("receiver.noise_after_gain_db", layout.after_db);
  }
  for (int beam = 0; beam < layout.beams; ++beam) {
    if (layout.taper >= 0) {
      builder.Add(fmt::format("receiver.noise_taper_db.{}", beam), "dB", layout.taper + beam,
                  law.receiver.noise_taper_db[beam], 0.0, -500.0, 500.0);
    }
  }
  for (int beam = 0; beam < layout.beams; ++beam) {
    if (layout.after_taper >= 0) {
      builder.Add(fmt::format("receiver.noise_after_gain_taper_db.{}", beam), "dB", layout.after_taper + beam,
                  law.receiver.noise_after_gain_taper_db[beam], 0.0, -500.0, 500.0);
    }
  }
  FitReport report = builder.Finish(correlated);
  report.gauge = GaugeOf(law, fit_span);
  report.cost_initial = solution.cost_initial;
  report.cost_final = solution.cost;
  report.iterations = solution.iterations;
  report.termination = solution.converged ? "converged" : "ended before it converged";
  if (frames_used < 5) {
    report.gauge.emplace_back(
        "Fewer than five pings: sigmas take range bands for independent, and know nothing of drift from ping "
        "to "
        "ping.");
  }
  return report;
}

}  // namespace sonarcal
