// Result of a fit, in the words of `fit.json`.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "calib/fitted_curve.h"
#include "calib/models/frame_saturation.h"
#include "core/types/words.h"

namespace sonarcal::calib {

enum class ParameterStatus { kFree, kFixed, kUnidentifiable, kAtBound };
constexpr auto WordsOf(std::type_identity<ParameterStatus>) {
  return Words<ParameterStatus, 4>{{{"free", ParameterStatus::kFree},
                                    {"fixed", ParameterStatus::kFixed},
                                    {"unidentifiable", ParameterStatus::kUnidentifiable},
                                    {"at_bound", ParameterStatus::kAtBound}}};
}

struct ReportedNormal {
  double value = 0.0;
  double sigma = 0.0;
};

struct FittedParameter {
  std::string name;
  std::string unit;
  double value = 0.0;
  std::optional<double> sigma;  // free parameters only
  double initial = 0.0;
  double lower = 0.0;
  double upper = 0.0;
  ParameterStatus status = ParameterStatus::kFixed;
  std::optional<double> truth = {};  // known for simulated recordings only
  // Absent for a fixed parameter and in a fit without priors. A parameter that is fitted as a logarithm has a
  // normal law of its logarithm, with the standard deviation sigma / value.
  std::optional<ReportedNormal> prior = {};
};

struct ResidualSummary {
  double mean = 0.0;
  double spread = 0.0;  // standard deviation
};

// Level that backscatter curves refer to: source level plus gain.
struct CurvesLevel {
  double level_db = 0.0;
  // Its standard error, from a standard target. The curves are then backscattering strength S_b, absolute up
  // to this error. Absent: they hold relative to the level, whose value was given.
  std::optional<double> sigma_db = {};
};

// Gain of the pose of each ping over one pose per frame (calib/selection/ping_worth.h).
struct PingWorth {
  bool used = true;              // the fit gave each beam the pose of its ping
  bool held_out = true;          // `frames` are held-out ones; otherwise fitted ones
  std::vector<int> frames = {};  // on which the gain was measured
  int pings = 0;                 // per frame
  double period_s = 0.0;
  double max_turn_deg = 0.0;  // of the sonar from the first to the last ping of a frame
  double max_distance_m = 0.0;
  double gain_nats_per_pixel = 0.0;  // of the log-likelihood, with the same values
  double gain_sigma = 0.0;           // its standard error
};

struct FitReport {
  // Reasons to doubt the fit: one full sentence each, without a full stop. Shown before any figure.
  std::vector<std::string> warnings;
  std::vector<FittedParameter> parameters;
  std::vector<std::string> gauge;                      // what was fixed and why, one sentence each
  std::vector<std::string> unidentifiable_directions;  // one sentence each
  std::vector<std::string> other_poses;                // poses that fit equally well, one sentence each
  // Errors of other things that would explain a fitted value as well, one sentence each.
  std::vector<std::string> ambiguities;
  std::vector<std::string> correlation_names;  // free parameters
  Eigen::MatrixXd correlation;
  std::vector<FittedCurve> curves;
  std::optional<CurvesLevel> curves_level;    // acoustic model only
  std::optional<ResidualSummary> raw;         // grey levels, full scale 1; absent for a likelihood
  ResidualSummary whitened;                   // has a standard deviation of 1 if the model is right
  std::optional<PingWorth> pings;             // absent: all beams of a frame have its pose
  std::optional<double> down_weighted_share;  // share of the pixels with a weight below 0.5
  std::vector<double> start_costs;            // cost at the end of each start, roughly solved
  double cost_initial = 0.0;
  double cost_final = 0.0;
  int iterations = 0;
  std::string termination;
  std::vector<int> frames_used;
  std::vector<int> frames_held_out;
  // Frames, used or held out, with traces of a saturated receiver. Absent: not looked for.
  std::optional<std::vector<FrameSaturation>> saturation = {};
  double trace_s = 0.0;
  // Time of the whole fit. For the acoustic model, includes tracing and gathering during the fit.
  double solve_s = 0.0;
  long rays_cast = 0;

  const FittedParameter* Find(const std::string& name) const;
};

// Returns what the curves are, and the level that they refer to, as a sentence without a full stop. Empty if
// the report has no level.
std::string CurvesLevelText(const FitReport& report);

// Returns true if the true value of any parameter is known.
bool HasTruth(const FitReport& report);

// Returns the object of `fit.json` as JSON text. `extra_members`: JSON text of further members, such as
// `"metrics_before": {...}`, or empty.
std::string FitReportJson(const FitReport& report, const std::string& extra_members = {});

}  // namespace sonarcal::calib
