#include "calib/models/one_curve_model.h"

#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "calib/models/acoustic_evaluation.h"
#include "calib/models/pixel_math.h"

namespace sonarcal::calib {
namespace {

class OneCurveEvaluation final : public FrameEvaluation {
 public:
  // `columns`: of each active entry, its index in a row of the table; 0 if the curve does not depend on it.
  OneCurveEvaluation(const OneCurvePixels& pixels, std::vector<double> curve,
                     std::vector<std::size_t> columns, FrameModel::Terms wanted)
      : pixels_(pixels), curve_(std::move(curve)), columns_(std::move(columns)), wanted_(wanted) {}

  bool Bins(int first, int last, PixelTerms& terms) const override {
    const auto count = static_cast<std::size_t>(last - first);
    const bool derivatives = wanted_ != FrameModel::Terms::kResiduals;
    thread_local std::vector<std::uint32_t> pixels;
    thread_local std::vector<double> sums;
    thread_local std::vector<double> mean;
    pixels.resize(count);
    std::iota(pixels.begin(), pixels.end(), static_cast<std::uint32_t>(first));
    sums.resize(count * sim::kCurveStride);
    mean.resize(count);
    pixel_math::SumCurves(pixels_.echoes, pixels, curve_, sums.data());
    bool valid = true;
    for (std::size_t i = 0; i < count; ++i) {
      mean[i] = pixels_.rest[first + i] + sums[i * sim::kCurveStride];
      valid = valid && mean[i] > 0.0 && std::isfinite(mean[i]);
    }
    if (!valid) return false;
    terms.residual.resize(count);
    terms.slope.resize(count);
    terms.information.assign(wanted_ == FrameModel::Terms::kInformation ? count : 0, 0.0);
    terms.eta_jacobian.assign(derivatives ? count * columns_.size() : 0, 0.0);
    terms.repeat_factor.clear();
    pixel_math::Likelihood(&pixels_.power[first], mean.data(), static_cast<int>(count), pixels_.looks,
                           terms.residual.data(), terms.slope.data());
    for (std::size_t i = 0; i < count; ++i) {
      const double weight = pixels_.weight[first + i];
      const double root = std::sqrt(weight);
      terms.residual[i] *= root;
      terms.slope[i] *= root;
      if (!terms.information.empty()) terms.information[i] = weight * pixels_.looks;
      if (!derivatives) continue;
      for (std::size_t k = 0; k < columns_.size(); ++k) {
        if (columns_[k] == 0) continue;
        terms.eta_jacobian[i * columns_.size() + k] = sums[i * sim::kCurveStride + columns_[k]] / mean[i];
      }
    }
    return true;
  }

 private:
  const OneCurvePixels& pixels_;
  std::vector<double> curve_;
  std::vector<std::size_t> columns_;
  FrameModel::Terms wanted_;
};

bool IsOfCurve(const CatalogEntry& entry, int material) {
  return entry.group == ParameterGroup::kGsab && entry.material == material;
}

}  // namespace

std::vector<double> CurveTable(const std::vector<CatalogEntry>& catalog, int material,
                               const ParameterValues& values) {
  std::array<double, sim::kCurveTerms - 1> of_curve{};
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (IsOfCurve(catalog[i], material)) of_curve[catalog[i].index] = values[i];
  }
  const auto [a, b, c, d, e, f] = of_curve;
  std::vector<double> table;
  AppendCurve({.a = a, .b_deg = b, .c = c, .d = d, .e = e, .f_deg = f}, table);
  return table;
}

std::vector<std::size_t> CurveColumns(const std::vector<CatalogEntry>& catalog, int material,
                                      std::span<const int> entries) {
  std::vector<std::size_t> columns;
  for (const int entry : entries) {
    const CatalogEntry& of = catalog[entry];
    columns.push_back(IsOfCurve(of, material) ? 1 + static_cast<std::size_t>(of.index) : 0);
  }
  return columns;
}

OneCurveModel::OneCurveModel(const FrameModel& of, int material, OneCurvePixels pixels)
    : of_(of), material_(material), pixels_(std::move(pixels)) {}

std::unique_ptr<FrameEvaluation> OneCurveModel::At(int /*frame*/, const ParameterValues& values,
                                                   std::span<const int> active, Terms wanted) const {
  std::vector<std::size_t> columns;
  if (wanted != Terms::kResiduals) columns = CurveColumns(catalog(), material_, active);
  return std::make_unique<OneCurveEvaluation>(pixels_, CurveTable(catalog(), material_, values),
                                              std::move(columns), wanted);
}

std::unique_ptr<FrameModel> OneCurveModel::Quadratic(const ParameterValues& values) const {
  const std::vector<double> table = CurveTable(catalog(), material_, values);
  const auto nodes = static_cast<Eigen::Index>(table.size()) / sim::kCurveStride;
  PixelTerms terms;
  if (!At(0, values, {}, Terms::kDerivatives)->Bins(0, range_bins(), terms)) return nullptr;
  QuadraticCost cost{.at = Eigen::VectorXd::Zero(nodes),
                     .gradient = Eigen::VectorXd::Zero(nodes),
                     .curvature = Eigen::MatrixXd::Zero(nodes, nodes)};
  for (Eigen::Index node = 0; node < nodes; ++node) cost.at(node) = table[node * sim::kCurveStride];
  for (std::size_t pixel = 0; pixel < pixels_.rest.size(); ++pixel) {
    const std::span entries(pixels_.echoes.entries.begin() + pixels_.echoes.start[pixel],
                            pixels_.echoes.entries.begin() + pixels_.echoes.start[pixel + 1]);
    double mean = pixels_.rest[pixel];
    for (const auto& [node, weight] : entries) mean += weight * cost.at(node);
    const double along = terms.slope[pixel] * terms.residual[pixel] / mean;
    const double information = pixels_.weight[pixel] * pixels_.looks / (mean * mean);
    for (const auto& [row, weight] : entries) {
      cost.gradient(row) += along * weight;
      for (const auto& [column, other] : entries) cost.curvature(row, column) += information * weight * other;
    }
    cost.cost += 0.5 * terms.residual[pixel] * terms.residual[pixel];
  }
  return std::make_unique<CurveQuadratic>(*this, material_, cost);
}

std::unique_ptr<OneCurveModel> FrameModel::OfCurve(int /*material*/,
                                                   const ParameterValues& /*values*/) const {
  return nullptr;
}

}  // namespace sonarcal::calib
