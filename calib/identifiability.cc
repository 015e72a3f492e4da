#include "calib/identifiability.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "data_io/types/error.h"

namespace sonarcal {
namespace {

// Parameters that take part in a direction with at least this share of its largest component are named.
constexpr double kNamedShare = 0.3;

}  // namespace

NormalEquations HoldParameter(const NormalEquations& equations, int parameter) {
  std::vector<int> kept;
  for (int i = 0; i < equations.information.rows(); ++i) {
    if (i != parameter) kept.push_back(i);
  }
  NormalEquations held = equations;
  held.information = equations.information(kept, kept);
  for (std::size_t i = 0; i < equations.blocks.size(); ++i) {
    held.blocks[i].information = equations.blocks[i].information(kept, kept);
    held.blocks[i].score = equations.blocks[i].score(kept);
  }
  return held;
}

std::optional<OpenDirection> LeastDetermined(const NormalEquations& equations,
                                             const Eigen::VectorXd& typical_step,
                                             const std::vector<std::string>& names) {
  const Eigen::Index n = equations.information.rows();
  SONARCAL_CHECK(n == typical_step.size() && n == static_cast<Eigen::Index>(names.size()),
                 "{} parameters, {} names", n, names.size());
  if (n == 0) return std::nullopt;
  const double variance =
      equations.residual_square / static_cast<double>(std::max<long>(1, equations.residual_count - n));
  const Eigen::MatrixXd scaled =
      typical_step.asDiagonal() * equations.information * typical_step.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  const double eigenvalue = std::max(0.0, solver.eigenvalues()(0));  // ascending
  const Eigen::VectorXd direction = solver.eigenvectors().col(0);
  // Rounding alone gives eigenvalues of this size to a singular matrix.
  const double rounding = 1e-12 * std::max(0.0, solver.eigenvalues()(n - 1));
  const double sigma_of_largest = std::sqrt(variance / eigenvalue) * direction.cwiseAbs().maxCoeff();
  if (eigenvalue > rounding && sigma_of_largest <= 1.0) return std::nullopt;

  std::vector<int> order(n);
  for (int i = 0; i < n; ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::abs(direction(a)) > std::abs(direction(b)); });
  const double largest = std::abs(direction(order[0]));
  std::string text;
  for (const int i : order) {
    if (std::abs(direction(i)) < kNamedShare * largest) break;
    const double sign = direction(i) * direction(order[0]) > 0.0 ? 1.0 : -1.0;
    text +=
        fmt::format("{}{}{}", text.empty() ? "" : " with ", sign < 0.0 ? "the opposite of " : "", names[i]);
  }
  return OpenDirection{order[0], text};
}

Eigen::MatrixXd JackknifeCovariance(const NormalEquations& equations) {
  const Eigen::Index n = equations.information.rows();
  // Scaled to a unit diagonal first: parameters differ by many orders of magnitude.
  const Eigen::VectorXd scale = equations.information.diagonal().cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (const NormalEquations::Block& block : equations.blocks) {
    const Eigen::MatrixXd rest =
        scale.asDiagonal() * (equations.information - block.information) * scale.asDiagonal();
    const Eigen::VectorXd change = scale.asDiagonal() * rest.ldlt().solve(scale.asDiagonal() * block.score);
    covariance += change * change.transpose();
  }
  const double count = static_cast<double>(equations.blocks.size());
  return covariance * ((count - 1.0) / count);
}

Eigen::MatrixXd CorrelationFromCovariance(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd inverse_sigma = covariance.diagonal().cwiseSqrt().cwiseInverse();
  return inverse_sigma.asDiagonal() * covariance * inverse_sigma.asDiagonal();
}

}  // namespace sonarcal
