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
                           : Column{Of::kSlope, static_cast<std::size_t>(slope - slopes_.begin())});
  }
}

PaperEvaluation::Column PaperEvaluation::PlanColumn(const CatalogEntry& entry) const {
  if (entry.group == ParameterGroup::kGsab)
    return {Of::kCurve, std::size_t{sim::kCurveStride} * entry.material + 1 + entry.index};
  if (entry.group == ParameterGroup::kSourceLevel) return {Of::kSourceLevel, 0};
  return {entry.key == "db_min" ? Of::kDisplayMin : Of::kDisplayMax, 0};
}

template <typename Body>
void PaperEvaluation::ForPixels(std::size_t first, std::size_t last, const Body& body) const {
  thread_local std::vector<std::uint32_t> pixels;
  thread_local std::vector<double> sums;
  const std::size_t stride = materials_ * sim::kCurveStride;
  for (std::size_t begin = first; begin < last; begin += pixel_math::kPixelsAtOnce) {
    pixels.resize(std::min(pixel_math::kPixelsAtOnce, last - begin));
    std::iota(pixels.begin(), pixels.end(), static_cast<std::uint32_t>(begin));
    sums.resize(pixels.size() * stride);
    pixel_math::SumCurves(echoes_->nodes, pixels, *table_, sums.data());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const double* of = &sums[i * stride];
      double sum = -echoes_->loss_db[begin + i] / span_db_;
      for (std::size_t material = 0; material < materials_; ++material)
        sum += of[material * sim::kCurveStride];
      body(begin + i, of, sum);
    }
  }
}

std::vector<double> PaperEvaluation::Sums() const {
  std::vector<double> all(echoes_->loss_db.size());
  ForPixels(0, all.size(), [&](std::size_t pixel, const double*, double sum) { all[pixel] = sum; });
  return all;
}

double PaperEvaluation::Derivative(const Column& column, std::size_t pixel, const double* sums,
                                   double sum) const {
  switch (column.of) {
    case Of::kCurve:
      return sums[column.index];
    case Of::kSlope:
      return slopes_[column.index].image[pixel];
    case Of::kDisplayMax:
      return -sum / span_db_;
    default:
      break;
  }
  double by_level = 0.0;
  for (std::size_t material = 0; material < materials_; ++material)
    by_level += sums[material * sim::kCurveStride + kOfLevel];
  return column.of == Of::kSourceLevel ? by_level : sum / span_db_ - by_level;
}

PaperResidual PaperEvaluation::ResidualOf(double sum, double recorded) const {
  if (likelihood_ != nullptr) return likelihood_->Residual(sum, recorded, recorded_.level);
  const bool clamped = sum < 0.0 || sum > 1.0;
  return {std::clamp(sum, 0.0, 1.0) - recorded, clamped ? 0.0 : 1.0};
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
  ForPixels(first_pixel, first_pixel + count, [&](std::size_t pixel, const double* sums, double sum) {
    if (!recorded_.use.empty() && recorded_.use[pixel] == 0) return;
    const std::size_t i = pixel - first_pixel;
    const PaperResidual of = ResidualOf(sum, recorded_.measured[pixel]);
    terms.residual[i] = of.residual;
    terms.slope[i] = of.slope;
    if (!derivatives || of.slope == 0.0) return;
    terms.information[i] = of.slope * of.slope;
    for (std::size_t k = 0; k < columns; ++k)
      terms.eta_jacobian[i * columns + k] = Derivative(columns_[k], pixel, sums, sum);
  });
  return true;
}

}  // namespace sonarcal::calib
