// What a fit found, in the words of `fit.json`.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "calib/fitted_curve.h"
#include "core/types/words.h"

namespace sonarcal::calib {

enum class ParameterStatus { kFree, kFixed, kUnidentifiable, kAtBound };
constexpr auto WordsOf(std::type_identity<ParameterStatus>) {
  return Words<ParameterStatus, 4>{{{"free", ParameterStatus::kFree},
                                    {"fixed", ParameterStatus::kFixed},
                                    {"unidentifiable", ParameterStatus::kUnidentifiable},
                                    {"at_bound", ParameterStatus::kAtBound}}};
}

struct FittedParameter {
  std::string name;
  std::string unit;
  double value = 0.0;
  std::optional<double> sigma;  // free parameters only
  double initial = 0.0;
  double lower = 0.0;
  double upper = 0.0;
  ParameterStatus status = ParameterStatus::kFixed;
  std::optional<double> truth = {};  // known of simulated recordings only
};

struct ResidualSummary {
  double mean = 0.0;
  double spread = 0.0;  // standard deviation
};

struct FitReport {
  // Reasons to doubt the fit: one full sentence each, without a full stop. Shown before any figure.
  std::vector<std::string> warnings;
  std::vector<FittedParameter> parameters;
  std::vector<std::string> gauge;                      // what was fixed and why, in words
  std::vector<std::string> unidentifiable_directions;  // in words
  std::vector<std::string> other_poses;                // that fit as well, in words
  std::vector<std::string> correlation_names;          // free parameters
  Eigen::MatrixXd correlation;
  std::vector<FittedCurve> curves;
  std::optional<ResidualSummary> raw;         // grey levels, of full scale 1; a likelihood has none
  ResidualSummary whitened;                   // of standard deviation 1 where the model is right
  std::optional<double> down_weighted_share;  // of the pixels: they count for less than half
  std::vector<double> start_costs;            // where each start ended, roughly solved
  double cost_initial = 0.0;
  double cost_final = 0.0;
  int iterations = 0;
  std::string termination;
  std::vector<int> frames_used;
  std::vector<int> frames_held_out;
  double trace_s = 0.0;
  double solve_s =
      0.0;  // of the whole fit; of the acoustic model, what it traces and gathers itself included
  long rays_cast = 0;

  const FittedParameter* Find(const std::string& name) const;
};

// Whether the true value of any parameter is known.
bool HasTruth(const FitReport& report);

// The object of `fit.json` as JSON text; `extra_members` is JSON text of further members, such as
// `"metrics_before": {...}`, or empty.
std::string FitReportJson(const FitReport& report, const std::string& extra_members = {});

}  // namespace sonarcal::calib
