// What a Jacobian says about parameters: their covariance, and what the data leave open.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace sonarcal {

// Sums over the residuals of a least-squares problem, at its solution.
struct NormalEquations {
  Eigen::MatrixXd information;  // J^T J
  Eigen::MatrixXd scatter;      // sum over blocks of (J_b^T r_b)(J_b^T r_b)^T
  double residual_square = 0.0;
  long residual_count = 0;
  long block_count = 0;
};

struct OpenDirection {
  int parameter = 0;        // the one that takes part most
  std::string description;  // in words
};

// The direction the data determine least, where along it the parameter that moves most has a standard
// deviation of more than one typical step; nothing where all are determined. `typical_step` scales each
// parameter.
std::optional<OpenDirection> LeastDetermined(const NormalEquations& equations,
                                             const Eigen::VectorXd& typical_step,
                                             const std::vector<std::string>& names);

// Sandwich covariance (Huber; White): (J^T J)^-1 scatter (J^T J)^-1 with the small-sample factor B / (B - 1).
// The information must be invertible.
Eigen::MatrixXd SandwichCovariance(const NormalEquations& equations);

Eigen::MatrixXd CorrelationFromCovariance(const Eigen::MatrixXd& covariance);

}  // namespace sonarcal
