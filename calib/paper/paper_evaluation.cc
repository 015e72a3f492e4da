#include "calib/paper/paper_evaluation.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "calib/models/curve_table.h"
#include "calib/models/pixel_math.h"
#include "sim/physics/gsab.h"

namespace sonarcal::calib {
namespace {

// Index of the derivative by the source level among the values of a node.
constexpr std::size_t kOfLevel = sim::kCurveTerms;
static_assert(kOfLevel < sim::kCurveStride);

}  // namespace

void AppendEchoes(const sim::PaperParameters<double>& parameters, const GsabParameters<double>& curve,
                  std::vector<double>& table) {
  const double per_db = 1.0 / (parameters.display.db_max - parameters.display.db_min);
  const CurveDual without_loss(sim::NormalisedPaperEcho(parameters, 0.0, 0.0));
  const GsabParameters<CurveDual> gsab = WithDerivatives(curve);
  for (std::size_t node = 0; node < sim::CoarseIncidenceDeg().size(); ++node)
    AppendNode(without_loss + per_db * sim::GsabDb(gsab, sim::PaperIncidenceDeg(node)), table, per_db);
}

std::vector<double> TabulateEchoes(const sim::PaperParameters<double>& parameters) {
  std::vector<double> table;
  for (const GsabParameters<double>& curve : parameters.materials) AppendEchoes(parameters, curve, table);
  return table;
}

PaperEvaluation::PaperEvaluation(const std::vector<CatalogEntry>& catalog,
                                 const sim::PaperParameters<double>& parameters,
                                 std::shared_ptr<const std::vector<double>> table,
                                 std::shared_ptr<const sim::PaperEchoes> echoes, const PaperRecord& recorded,
                                 int beams, const PaperLikelihood* likelihood, std::span<const int> active,
                                 std::vector<PaperSlope> slopes, FrameModel::Terms wanted)
    : echoes_(std::move(echoes)),
      recorded_(recorded),
      beams_(beams),
      likelihood_(likelihood),
      slopes_(std::move(slopes)),
      wanted_(wanted),
      materials_(parameters.materials.size()),
      span_db_(parameters.display.db_max - parameters.display.db_min),
      table_(std::move(table)) {
  if (wanted == FrameModel::Terms::kResiduals) return;
  for (const int entry : active) {
    const auto slope = std::ranges::find(slopes_, entry, &PaperSlope::entry);
    columns_.push_back(slope == slopes_.end()
                           ? PlanColumn(catalog[entry])
                           : Column{Of::kSlope, 0, static_cast<std::size_t>(slope - slopes_.begin())});
    if (columns_.back().of != Of::kCurve) not_of_curves_.push_back(columns_.size() - 1);
  }
}

PaperEvaluation::Column PaperEvaluation::PlanColumn(const CatalogEntry& entry) {
  if (entry.group == ParameterGroup::kGsab)
    return {Of::kCurve, std::size_t{sim::kCurveStride} * entry.material + 1 + entry.index};
  if (entry.group == ParameterGroup::kSourceLevel) return {Of::kSourceLevel};
  return {entry.key == "db_min" ? Of::kDisplayMin : Of::kDisplayMax};
}

template <typename Body>
void PaperEvaluation::ForLit(std::size_t first, std::size_t last, const Body& body) const {
  thread_local std::vector<std::uint32_t> pixels;
  thread_local std::vector<double> sums;
  thread_local std::vector<double> total;
  const std::size_t stride = materials_ * sim::kCurveStride;
  const std::uint32_t* start = echoes_->nodes.start.data();
  std::size_t next = first;
  while (next < last) {
    pixels.clear();
    for (; next < last && pixels.size() < pixel_math::kPixelsAtOnce; ++next) {
      if (start[next] != start[next + 1]) pixels.push_back(static_cast<std::uint32_t>(next));
    }
    sums.resize(pixels.size() * stride);
    pixel_math::SumCurves(echoes_->nodes, pixels, *table_, sums.data());
    total.resize(pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      total[i] = -echoes_->loss_db[pixels[i]] / span_db_;
      for (std::size_t material = 0; material < materials_; ++material)
        total[i] += sums[i * stride + material * sim::kCurveStride];
    }
    body(Lit{.pixels = pixels, .sums = sums, .total = total});
  }
}

std::vector<double> PaperEvaluation::Sums() const {
  std::vector<double> all(echoes_->loss_db.size(), 0.0);
  ForLit(0, all.size(), [&](const Lit& lit) {
    for (std::size_t i = 0; i < lit.pixels.size(); ++i) all[lit.pixels[i]] = lit.total[i];
  });
  return all;
}

double PaperEvaluation::Derivative(const Column& column, std::size_t pixel, const double* sums,
                                   double total) const {
  switch (column.of) {
    case Of::kSlope:
      return slopes_[column.slope].image[pixel];
    case Of::kDisplayMax:
      return -total / span_db_;
    default:
      break;
  }
  double by_level = 0.0;
  for (std::size_t material = 0; material < materials_; ++material)
    by_level += sums[material * sim::kCurveStride + kOfLevel];
  return column.of == Of::kSourceLevel ? by_level : total / span_db_ - by_level;
}

void PaperEvaluation::Residuals(std::span<const double> total, std::span<const double> recorded,
                                std::span<PaperResidual> residuals) const {
  if (likelihood_ != nullptr) {
    likelihood_->Residuals(total, recorded, recorded_.level, residuals);
    return;
  }
  for (std::size_t i = 0; i < total.size(); ++i) {
    const double shown = std::clamp(total[i], 0.0, 1.0);
    residuals[i] = {shown - recorded[i], shown == total[i] ? 1.0 : 0.0};
  }
}

bool PaperEvaluation::Bins(int first, int last, PixelTerms& terms) const {
  const std::size_t first_pixel = first * beams_;
  const std::size_t count = last * beams_ - first_pixel;
  const std::size_t columns = columns_.size();
  const bool derivatives = wanted_ != FrameModel::Terms::kResiduals;
  terms.residual.assign(count, 0.0);
  terms.slope.assign(count, 0.0);
  terms.information.assign(derivatives ? count : 0, 0.0);
  terms.eta_jacobian.assign(derivatives ? count * columns : 0, 0.0);
  terms.repeat_factor.clear();
  const auto counts = [&](std::size_t pixel) { return recorded_.use.empty() || recorded_.use[pixel] != 0; };
  // Whatever the noise, the expected value of a pixel without an echo is 0.
  const double per_sigma = likelihood_ != nullptr ? 1.0 / likelihood_->noise().sigma : 1.0;
  for (std::size_t i = 0; i < count; ++i) {
    if (counts(first_pixel + i)) terms.residual[i] = -recorded_.measured[first_pixel + i] * per_sigma;
  }
  thread_local std::vector<double> recorded;
  thread_local std::vector<PaperResidual> residuals;
  ForLit(first_pixel, first_pixel + count, [&](const Lit& lit) {
    recorded.clear();
    for (const std::uint32_t pixel : lit.pixels) recorded.push_back(recorded_.measured[pixel]);
    residuals.resize(lit.pixels.size());
    Residuals(lit.total, recorded, residuals);
    const std::size_t stride = materials_ * sim::kCurveStride;
    for (std::size_t n = 0; n < lit.pixels.size(); ++n) {
      const std::size_t pixel = lit.pixels[n];
      if (!counts(pixel)) continue;
      const std::size_t i = pixel - first_pixel;
      const auto [residual, slope] = residuals[n];
      terms.residual[i] = residual;
      terms.slope[i] = slope;
      if (!derivatives || slope == 0.0) continue;
      terms.information[i] = slope * slope;
      const double* sums = &lit.sums[n * stride];
      double* row = &terms.eta_jacobian[i * columns];
      for (std::size_t k = 0; k < columns; ++k) row[k] = sums[columns_[k].index];
      for (const std::size_t k : not_of_curves_) row[k] = Derivative(columns_[k], pixel, sums, lit.total[n]);
    }
  });
  return true;
}

}  // namespace sonarcal::calib
