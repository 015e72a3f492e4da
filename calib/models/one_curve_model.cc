#include "calib/models/one_curve_model.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "calib/models/pixel_math.h"

namespace sonarcal::calib {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class OneCurveEvaluation final : public FrameEvaluation {
 public:
  // `columns`: of each active entry, its index in a row of the table; 0 if the curve does not depend on it.
  OneCurveEvaluation(const OneCurvePixels& pixels, const PixelLaw& law, std::vector<double> curve,
                     std::vector<std::size_t> columns)
      : pixels_(pixels), law_(law), curve_(std::move(curve)), columns_(std::move(columns)) {}

  bool Bins(int first, int last, PixelTerms& terms) const override {
    const auto count = static_cast<std::size_t>(last - first);
    thread_local std::vector<std::uint32_t> pixels;
    thread_local std::vector<double> sums;
    thread_local std::vector<double> mean;
    pixels.resize(count);
    std::iota(pixels.begin(), pixels.end(), static_cast<std::uint32_t>(first));
    sums.resize(count * sim::kCurveStride);
    mean.resize(count);
    pixel_math::SumCurves(pixels_.echoes, pixels, curve_, sums.data());
    for (std::size_t i = 0; i < count; ++i) mean[i] = pixels_.rest[first + i] + sums[i * sim::kCurveStride];
    terms.residual.resize(count);
    terms.slope.resize(count);
    terms.information.resize(count);
    terms.eta_jacobian.assign(count * columns_.size(), 0.0);
    terms.repeat_factor.clear();
    if (!law_.Judge(first, mean, terms)) return false;
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      if (columns_[k] == 0) continue;
      for (std::size_t i = 0; i < count; ++i)
        terms.eta_jacobian[i * columns_.size() + k] = sums[i * sim::kCurveStride + columns_[k]];
    }
    return true;
  }

 private:
  const OneCurvePixels& pixels_;
  const PixelLaw& law_;
  std::vector<double> curve_;
  std::vector<std::size_t> columns_;
};

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

// About a curve with the values `at`, one per coarse incidence node.
struct QuadraticCurveCost {
  Eigen::VectorXd at;
  double cost = 0.0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;  // expected information
};

// Each eigenvector of the curvature is a pixel: its residual is linear in the values of the nodes.
class CurveQuadratic final : public FrameOfCurve {
 public:
  // The law must outlive it.
  CurveQuadratic(const FrameModel& of, int material, const PixelLaw& law, const QuadraticCurveCost& cost);

  int range_bins() const override { return static_cast<int>(offset_.size()); }
  std::unique_ptr<FrameEvaluation> At(int frame, const ParameterValues& values, std::span<const int> active,
                                      Terms wanted) const override;

 private:
  const PixelLaw& law_;
  Eigen::MatrixXd by_node_;  // residuals = by_node_ * values of the nodes + offset_
  Eigen::VectorXd offset_;
};

CurveQuadratic::CurveQuadratic(const FrameModel& of, int material, const PixelLaw& law,
                               const QuadraticCurveCost& cost)
    : FrameOfCurve(of, material), law_(law) {
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
  const std::vector<double> table = law_.Table(CurveAt(values));
  const Eigen::Map<const RowMajor> rows(table.data(), by_node_.cols(), sim::kCurveStride);
  const std::vector<std::size_t> columns =
      wanted == Terms::kResiduals ? std::vector<std::size_t>() : CurveColumns(active);
  RowMajor by_entry = RowMajor::Zero(by_node_.cols(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (columns[k] > 0)
      by_entry.col(static_cast<Eigen::Index>(k)) = rows.col(static_cast<Eigen::Index>(columns[k]));
  }
  return std::make_unique<QuadraticEvaluation>(by_node_ * rows.col(0) + offset_, by_node_ * by_entry);
}

}  // namespace

bool OneCurvePixels::Add(const sim::PixelEchoes& from, std::size_t pixel, int material, double gain,
                         std::span<const double> table, double mean) {
  const auto nodes = static_cast<std::uint32_t>(sim::CoarseIncidenceDeg().size());
  const std::uint32_t first_node = nodes * static_cast<std::uint32_t>(material);
  double shown = 0.0;
  for (std::uint32_t e = from.start[pixel]; e < from.start[pixel + 1]; ++e) {
    const auto [node, weight] = from.entries[e];
    if (node < first_node || node >= first_node + nodes) continue;
    const auto amplified = static_cast<float>(gain * weight);
    echoes.entries.push_back({node - first_node, amplified});
    shown += amplified * table[std::size_t{sim::kCurveStride} * node];
  }
  const auto end = static_cast<std::uint32_t>(echoes.entries.size());
  if (end == echoes.start.back()) return false;
  echoes.start.push_back(end);
  rest.push_back(mean - shown);
  return true;
}

GsabParameters<double> FrameOfCurve::CurveAt(const ParameterValues& values) const {
  std::array<double, sim::kCurveTerms - 1> of_curve{};
  for (std::size_t i = 0; i < catalog().size(); ++i) {
    if (IsOfCurve(catalog()[i])) of_curve[catalog()[i].index] = values[i];
  }
  const auto [a, b, c, d, e, f] = of_curve;
  return {.a = a, .b_deg = b, .c = c, .d = d, .e = e, .f_deg = f};
}

std::vector<std::size_t> FrameOfCurve::CurveColumns(std::span<const int> entries) const {
  std::vector<std::size_t> columns;
  for (const int entry : entries) {
    const CatalogEntry& of = catalog()[entry];
    columns.push_back(IsOfCurve(of) ? 1 + static_cast<std::size_t>(of.index) : 0);
  }
  return columns;
}

std::unique_ptr<FrameEvaluation> OneCurveModel::At(int /*frame*/, const ParameterValues& values,
                                                   std::span<const int> active, Terms wanted) const {
  std::vector<std::size_t> columns;
  if (wanted != Terms::kResiduals) columns = CurveColumns(active);
  return std::make_unique<OneCurveEvaluation>(pixels_, *law_, law_->Table(CurveAt(values)),
                                              std::move(columns));
}

std::unique_ptr<FrameModel> OneCurveModel::Quadratic(const ParameterValues& values) const {
  const std::vector<double> table = law_->Table(CurveAt(values));
  const auto nodes = static_cast<Eigen::Index>(table.size()) / sim::kCurveStride;
  PixelTerms terms;
  if (!At(0, values, {}, Terms::kDerivatives)->Bins(0, range_bins(), terms)) return nullptr;
  QuadraticCurveCost cost{.at = Eigen::VectorXd::Zero(nodes),
                          .gradient = Eigen::VectorXd::Zero(nodes),
                          .curvature = Eigen::MatrixXd::Zero(nodes, nodes)};
  for (Eigen::Index node = 0; node < nodes; ++node) cost.at(node) = table[node * sim::kCurveStride];
  for (std::size_t pixel = 0; pixel < pixels_.rest.size(); ++pixel) {
    const std::span entries(pixels_.echoes.entries.begin() + pixels_.echoes.start[pixel],
                            pixels_.echoes.entries.begin() + pixels_.echoes.start[pixel + 1]);
    const double along = terms.slope[pixel] * terms.residual[pixel];
    const double information = terms.information[pixel];
    cost.cost += 0.5 * terms.residual[pixel] * terms.residual[pixel];
    if (along == 0.0 && information == 0.0) continue;
    for (const auto& [row, weight] : entries) {
      cost.gradient(row) += along * weight;
      for (const auto& [column, other] : entries) cost.curvature(row, column) += information * weight * other;
    }
  }
  return std::make_unique<CurveQuadratic>(of(), material(), *law_, cost);
}

std::unique_ptr<OneCurveModel> FrameModel::OfCurve(int /*material*/,
                                                   const ParameterValues& /*values*/) const {
  return nullptr;
}

}  // namespace sonarcal::calib
