// Tells which declared values a fit contradicts.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/fit_report.h"

namespace sonarcal::calib {

// Values that somebody declared, and how far a fit moves them. Values of one origin (a data sheet, a survey,
// a tape measure) are trusted together.
struct DeclaredValues {
  std::vector<std::string> origins;  // of each value
  Eigen::VectorXd moved;             // fitted minus declared
  Eigen::MatrixXd covariance;        // of the fit
};

// Returns the origins that the values contradict, in the order in which they come first. An origin is
// contradicted if the chi-square of its values exceeds its mean by two of its standard deviations. The origin
// that is contradicted least is set to its declared values, which changes the others as their covariance
// says, and so on until all that are left are contradicted. So of two origins that explain the same thing, at
// least one remains. The covariance must be positive definite.
std::vector<std::string> ContradictedOrigins(DeclaredValues values);

// Origin of a parameter that says where something is: "poses", "geometry of the sonar", or "object NAME".
// Empty for all other parameters.
std::string OriginOf(const std::string& parameter);

// Poses, geometry of the sonar and places of objects that a fit moved, against their initial values. Leaves
// out what has no standard error. Angles move by at most 180 degrees.
DeclaredValues DeclaredPlacement(const FitReport& report);

// Fitted minus initial value; for an angle, at most 180 degrees.
double Moved(const FittedParameter& parameter);

}  // namespace sonarcal::calib
