// Parameters and sentences of a fit to a standard target (calib/standard_target/standard_target_fit.h).
#pragma once

#include "calib/standard_target/point_echo_fit.h"
#include "calib/standard_target/standard_target_fit.h"
#include "core/types/parameters.h"
#include "core/types/sonar_model.h"

namespace sonarcal::calib {

struct FittedPointEcho {
  PointEchoData data;
  PointEchoFree free;
  PointEchoSolution solution;
  // Per decade of range, beyond the law of gain. 0 +- 0: the ranges do not determine it.
  double slope_db = 0.0;
  double slope_sigma_db = 0.0;

  double Sigma(int entry) const;  // standard error of an entry of solution.covariance
};

// Fills `fit.parameters` and `fit.report` from `state` and from the other members of `fit`.
void FillTargetReport(const FittedPointEcho& state, const SonarModel& sonar, const ParameterSet& initial,
                      StandardTargetFit& fit);

}  // namespace sonarcal::calib
