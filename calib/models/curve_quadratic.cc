#include "calib/models/curve_quadratic.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/models/one_curve_model.h"

namespace sonarcal::calib {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class QuadraticEvaluation final : public FrameEvaluation {
 public:
  QuadraticEvaluation(Eigen::VectorXd residual, RowMajor jacobian)
      : residual_(std::move(residual)), jacobian_(std::move(jacobian)) {}

  bool Bins(int first, int last, PixelTerms& terms) const override {
    const int count = last - first;
    terms.residual.assign(residual_.begin() + first, residual_.begin() + last);
    terms.slope.assign(count, 1.0);
    terms.information.assign(count, 1.0);
    terms.eta_jacobian.assign(jacobian_.data() + first * jacobian_.cols(),
                              jacobian_.data() + last * jacobian_.cols());
    terms.repeat_factor.clear();
    return residual_.allFinite();
  }

 private:
  Eigen::VectorXd residual_;
  RowMajor jacobian_;
};

}  // namespace

CurveQuadratic::CurveQuadratic(const FrameModel& of, int material, const QuadraticCost& cost)
    : of_(of), material_(material) {
  constexpr double kOfLargest = 1e-12;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(cost.curvature);
  const Eigen::Index nodes = cost.at.size();
  const double smallest = kOfLargest * std::max(solver.eigenvalues()(nodes - 1), 0.0);
  const auto open = static_cast<Eigen::Index>(
      std::ranges::count_if(solver.eigenvalues(), [&](double value) { return !(value > smallest); }));
  const Eigen::Index seen = nodes - open;
  const Eigen::VectorXd root = solver.eigenvalues().tail(seen).cwiseSqrt();
  const auto vectors = solver.eigenvectors().rightCols(seen);
  by_node_ = Eigen::MatrixXd::Zero(seen + 1, nodes);
  by_node_.topRows(seen) = root.asDiagonal() * vectors.transpose();
  offset_ = Eigen::VectorXd::Zero(seen + 1);
  offset_.head(seen) = (vectors.transpose() * cost.gradient).cwiseQuotient(root);
  // The last residual makes the cost that of the pixels.
  offset_(seen) = std::sqrt(std::max(2.0 * cost.cost - offset_.squaredNorm(), 0.0));
  offset_ -= by_node_ * cost.at;
}

std::unique_ptr<FrameEvaluation> CurveQuadratic::At(int /*frame*/, const ParameterValues& values,
                                                    std::span<const int> active, Terms wanted) const {
  const std::vector<double> table = CurveTable(catalog(), material_, values);
  const Eigen::Map<const RowMajor> rows(table.data(), by_node_.cols(), sim::kCurveStride);
  const std::vector<std::size_t> columns =
      wanted == Terms::kResiduals ? std::vector<std::size_t>() : CurveColumns(catalog(), material_, active);
  RowMajor by_entry = RowMajor::Zero(by_node_.cols(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (columns[k] > 0)
      by_entry.col(static_cast<Eigen::Index>(k)) = rows.col(static_cast<Eigen::Index>(columns[k]));
  }
  return std::make_unique<QuadraticEvaluation>(by_node_ * rows.col(0) + offset_, by_node_ * by_entry);
}

}  // namespace sonarcal::calib
