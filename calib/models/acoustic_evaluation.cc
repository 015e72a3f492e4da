#include "calib/models/acoustic_evaluation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "calib/models/curve_table.h"
#include "calib/models/pixel_math.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/display.h"
#include "sim/physics/gsab.h"

namespace sonarcal::calib {
namespace {

constexpr double kMaxGrowth = 3.0;  // max growth of an echo for which its slope holds, nepers of power

std::vector<double> TabulateCurves(const ParameterSet& parameters, const std::vector<std::string>& names) {
  std::vector<double> table;
  for (const std::string& name : names) AppendCurve(parameters.materials.at(name).gsab, table);
  return table;
}

// As TabulateCurves, for the two parts of each material, one after the other
// (sim/gathered/ghost_echoes.h). A node of the slow part is the angle of a mean cosine.
std::vector<double> TabulateParts(const ParameterSet& parameters, const std::vector<std::string>& names) {
  const std::vector<double>& nodes_deg = sim::CoarseIncidenceDeg();
  std::vector<double> table;
  for (const std::string& name : names) {
    const GsabParameters<CurveDual> gsab = WithDerivatives(parameters.materials.at(name).gsab);
    for (const double node_deg : nodes_deg) AppendNode(sim::GsabPeaksPower(gsab, node_deg), table);
    for (const double node_deg : nodes_deg) {
      AppendNode(node_deg < 90.0 ? sim::GsabSlowPower(gsab, std::cos(RadFromDeg(node_deg))) : CurveDual(0.0),
                 table);
    }
  }
  return table;
}

// Fraction of the power that the reflections of each path leave.
std::vector<double> PassedByWays(const ParameterSet& parameters, const std::vector<std::string>& names,
                                 const std::vector<sim::GhostWay>& ways) {
  std::vector<double> passed;
  for (const sim::GhostWay& way : ways) {
    double loss_db = 0.0;
    for (const std::uint16_t mirror : way) loss_db += parameters.mirrors.at(names[mirror]).loss_db;
    passed.push_back(PowerFromDb(-loss_db));
  }
  return passed;
}

}  // namespace

void AppendCurve(const GsabParameters<double>& gsab, std::vector<double>& table) {
  const GsabParameters<CurveDual> duals = WithDerivatives(gsab);
  for (const double node_deg : sim::CoarseIncidenceDeg()) AppendNode(sim::GsabPower(duals, node_deg), table);
}

AcousticEvaluation::AcousticEvaluation(const AcousticState& state, const FrameEchoes& echoes,
                                       const RecordedFrame& recorded, std::span<const int> active,
                                       FrameModel::Terms wanted)
    : echoes_(echoes),
      recorded_(recorded),
      wanted_(wanted),
      bins_(state.sonar.axes.range_bins),
      beams_(state.sonar.axes.beam_count()),
      materials_(state.material_names.size()),
      curves_(TabulateCurves(state.parameters, state.material_names)),
      passed_(PassedByWays(state.parameters, state.material_names, echoes.ghosts.ways)),
      noise_(state.parameters.receiver, state.sonar.axes, state.absorption_db_per_m),
      looks_(state.parameters.receiver.looks),
      clips_(state.clips),
      lowest_(sim::PowerFromDisplay(state.parameters.display, 0.0)),
      highest_(sim::PowerFromDisplay(state.parameters.display, 1.0)) {
  if (!passed_.empty()) parts_ = TabulateParts(state.parameters, state.material_names);
  for (const int entry : active) {
    columns_.push_back(PlanColumn(state, entry));
    if (columns_.back().of != Of::kCurve) continue;
    const CatalogEntry& of = state.catalog[entry];
    curve_columns_.push_back(
        {columns_.size() - 1, static_cast<std::size_t>(of.material * sim::kCurveStride + 1 + of.index)});
  }
  for (std::size_t g = 0; g < echoes.slopes.size(); ++g) {
    const int entry = echoes.slopes[g].entry;
    moved_.push_back(state.values[entry] - state.point[entry]);
    const bool differentiated =
        wanted != FrameModel::Terms::kResiduals && std::ranges::find(active, entry) != active.end();
    if (moved_.back() != 0.0 || differentiated) needed_slopes_.push_back(g);
  }
  const ReceiverParameters& receiver = state.parameters.receiver;
  for (int bin = 0; bin < bins_; ++bin) {
    range_m_.push_back(state.sonar.axes.range_centre_m(bin));
    gain_.push_back(PowerFromDb(
        state.parameters.source_level_db + receiver.gain_db +
        sim::TimeVariedGainDb(receiver.time_varied_gain, range_m_.back(), state.absorption_db_per_m)));
  }
}

AcousticEvaluation::Column AcousticEvaluation::PlanColumn(const AcousticState& state, int entry) const {
  const CatalogEntry& of = state.catalog[entry];
  if (IsGeometric(of)) {
    const auto found = std::find_if(echoes_.slopes.begin(), echoes_.slopes.end(),
                                    [entry](const EchoSlope& slope) { return slope.entry == entry; });
    if (found == echoes_.slopes.end()) return {};
    return {.of = Of::kGeometry, .geometry = static_cast<std::size_t>(found - echoes_.slopes.begin())};
  }
  if (of.group == ParameterGroup::kGsab) return {.of = Of::kCurve};
  if (of.group == ParameterGroup::kMirror) return {.of = Of::kMirror, .mirror = of.mirror};
  if (of.group == ParameterGroup::kReceiver && of.index == 1) return {.of = Of::kNoise};
  if (of.group == ParameterGroup::kReceiver && of.index == 2) return {.of = Of::kNoiseSlope};
  return {.of = Of::kLevel};  // gain and source level
}

bool AcousticEvaluation::SumEchoes(std::span<const std::uint32_t> pixels, Sums& sums) const {
  const std::size_t stride = materials_ * sim::kCurveStride;
  sums.curves.resize(pixels.size() * stride);
  sums.slopes.resize(pixels.size() * moved_.size());
  sums.power.resize(pixels.size());
  sums.mean.resize(pixels.size());
  sums.of_echo.resize(pixels.size());
  sums.of_noise.resize(pixels.size());
  pixel_math::SumCurves(echoes_.at_point, pixels, curves_, sums.curves.data());
  sums.ghosts.assign(pixels.size() * passed_.size(), 0.0);
  if (!passed_.empty()) {
    pixel_math::AddGhosts(echoes_.ghosts.pixels, pixels, parts_, passed_, sums.curves.data(),
                          sums.ghosts.data());
  }
  Scratch scratch;
  bool valid = true;
  int bin = pixels.empty() ? 0 : static_cast<int>(pixels.front()) / beams_;
  std::size_t end_of_bin = static_cast<std::size_t>(bin + 1) * beams_;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    while (pixels[i] >= end_of_bin) {
      ++bin;
      end_of_bin += beams_;
    }
    const int beam = static_cast<int>(pixels[i] + beams_ - end_of_bin);
    if (!needed_slopes_.empty()) MoveGeometry(pixels[i], i, scratch, sums);
    const double power = AllMaterials(&sums.curves[i * stride]);
    const double before_gain = noise_.BeforeGain(bin, beam);
    const double mean = gain_[bin] * std::max(power, 0.0) + noise_.Power(bin, beam);
    valid = valid && mean > 0.0 && std::isfinite(mean);
    sums.power[i] = power;
    sums.mean[i] = mean;
    // Far from the point, linear echoes may become negative: they count as 0.
    sums.of_echo[i] = power > 0.0 ? gain_[bin] / mean : 0.0;
    sums.of_noise[i] = kNeperPerDb * before_gain / mean;
  }
  return valid;
}

// Adds the effect of changes in beam, pulse and pose to the sums of a pixel. Leaves the derivatives by
// further changes in `sums.slopes`.
void AcousticEvaluation::MoveGeometry(std::uint32_t pixel, std::size_t i, Scratch& scratch,
                                      Sums& sums) const {
  const std::size_t stride = materials_ * sim::kCurveStride;
  const std::span<double> curves(&sums.curves[i * stride], stride);
  const std::span<double> ghosts(sums.ghosts.data() + i * passed_.size(), passed_.size());
  const std::span<double> slopes(&sums.slopes[i * moved_.size()], moved_.size());
  double grown = 0.0;  // by poses, in nepers
  for (const std::size_t g : needed_slopes_) {
    const EchoSlope& slope = echoes_.slopes[g];
    if (!slope.logarithm.empty()) {
      grown += moved_[g] * slope.logarithm[pixel];
      continue;
    }
    scratch.curves.assign(stride, 0.0);
    scratch.ghosts.assign(passed_.size(), 0.0);
    if (!slope.echoes.start.empty()) sim::AddCurves(slope.echoes, pixel, curves_, scratch.curves);
    if (!slope.ghosts.start.empty()) {
      pixel_math::AddGhosts(slope.ghosts, {&pixel, 1}, parts_, passed_, scratch.curves.data(),
                            scratch.ghosts.data());
    }
    slopes[g] = AllMaterials(scratch.curves.data());
    for (std::size_t k = 0; k < curves.size(); ++k) curves[k] += moved_[g] * scratch.curves[k];
    for (std::size_t k = 0; k < ghosts.size(); ++k) ghosts[k] += moved_[g] * scratch.ghosts[k];
  }
  const double factor = grown == 0.0 ? 1.0 : std::exp(std::clamp(grown, -kMaxGrowth, kMaxGrowth));
  for (double& value : curves) value *= factor;
  for (double& value : ghosts) value *= factor;
  const double power = AllMaterials(curves.data());
  for (const std::size_t g : needed_slopes_) {
    const EchoSlope& slope = echoes_.slopes[g];
    if (slope.logarithm.empty()) {
      slopes[g] *= factor;
    } else {
      slopes[g] = std::abs(grown) < kMaxGrowth ? slope.logarithm[pixel] * power : 0.0;
    }
  }
}

// d ln mean / d active values, column by column.
void AcousticEvaluation::FillJacobian(std::span<const std::uint32_t> pixels, const Sums& sums,
                                      std::size_t first_pixel, double* jacobian) const {
  const std::size_t columns = columns_.size();
  const std::size_t stride = materials_ * sim::kCurveStride;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    double* __restrict row = jacobian + (pixels[i] - first_pixel) * columns;
    const double* __restrict curves = &sums.curves[i * stride];
    const double of_echo = sums.of_echo[i];
    for (const CurveColumn& column : curve_columns_) row[column.column] = of_echo * curves[column.sum];
  }
  for (std::size_t k = 0; k < columns; ++k) {
    const auto fill = [&](const auto& slope_of) {
      for (std::size_t i = 0; i < pixels.size(); ++i)
        jacobian[(pixels[i] - first_pixel) * columns + k] = slope_of(i);
    };
    switch (columns_[k].of) {
      case Of::kGeometry:
        fill([&](std::size_t i) {
          return sums.of_echo[i] * sums.slopes[i * moved_.size() + columns_[k].geometry];
        });
        break;
      case Of::kMirror: {
        std::vector<double> times;  // number of reflections at it, per path
        for (const sim::GhostWay& way : echoes_.ghosts.ways)
          times.push_back(static_cast<double>(std::count(way.begin(), way.end(), columns_[k].mirror)));
        fill([&](std::size_t i) {
          const double* of_way = sums.ghosts.data() + i * times.size();
          return -kNeperPerDb * sums.of_echo[i] * std::inner_product(times.begin(), times.end(), of_way, 0.0);
        });
        break;
      }
      case Of::kLevel:
        fill([&](std::size_t i) { return kNeperPerDb * sums.of_echo[i] * sums.power[i]; });
        break;
      case Of::kNoise:
        fill([&](std::size_t i) { return sums.of_noise[i]; });
        break;
      case Of::kNoiseSlope:
        fill([&](std::size_t i) { return sums.of_noise[i] * range_m_[pixels[i] / beams_]; });
        break;
      case Of::kCurve:
      case Of::kNothing:
        break;
    }
  }
}

// Writes residuals, slopes and information to the places of the pixels.
void AcousticEvaluation::FillLikelihood(std::span<const std::uint32_t> pixels,
                                        const std::vector<double>& mean, std::size_t first_pixel,
                                        PixelTerms& terms) const {
  const auto count = static_cast<int>(pixels.size());
  thread_local std::vector<double> power;
  thread_local std::vector<double> residual;
  thread_local std::vector<double> slope;
  thread_local std::vector<double> information;
  power.clear();
  for (const std::uint32_t pixel : pixels) power.push_back(recorded_.power[pixel].power);
  residual.resize(pixels.size());
  slope.resize(pixels.size());
  information.resize(pixels.size());
  pixel_math::Likelihood(power.data(), mean.data(), count, looks_, residual.data(), slope.data());
  const bool informed = wanted_ == FrameModel::Terms::kInformation;
  const bool single_look = looks_ == 1.0 && clips_;
  if (informed && single_look)
    pixel_math::SingleLookInformation(lowest_, highest_, mean.data(), count, information.data());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const std::uint32_t pixel = pixels[i];
    const std::size_t at = pixel - first_pixel;
    const RecordedPower& recorded = recorded_.power[pixel];
    const LikelihoodTerm term = recorded.censoring == Censoring::kNone
                                    ? LikelihoodTerm{residual[i], slope[i]}
                                    : PowerLikelihood(recorded, mean[i], looks_);
    // A weight is an exponent of the likelihood: residual and slope are multiplied by its root, information
    // by the weight.
    const double share = recorded_.repeat_share.empty() ? 1.0 : recorded_.repeat_share[pixel];
    const double weight = share * (recorded_.weight.empty() ? 1.0 : recorded_.weight[pixel]);
    if (!recorded_.repeat_share.empty()) terms.repeat_factor[at] = std::sqrt(share);
    const double root = weight == 1.0 ? 1.0 : std::sqrt(weight);
    terms.residual[at] = root * term.residual;
    if (!terms.slope.empty()) terms.slope[at] = root * term.slope;
    if (informed) {
      terms.information[at] = weight * (single_look ? information[i] : Information(mean[i]));
    }
  }
}

bool AcousticEvaluation::Bins(int first, int last, PixelTerms& terms) const {
  const std::size_t pixels = static_cast<std::size_t>(last - first) * beams_;
  const std::size_t first_pixel = static_cast<std::size_t>(first) * beams_;
  const std::size_t columns = columns_.size();
  const bool derivatives = wanted_ != FrameModel::Terms::kResiduals;
  terms.residual.assign(pixels, 0.0);
  terms.slope.assign(derivatives ? pixels : 0, 0.0);
  terms.information.assign(wanted_ == FrameModel::Terms::kInformation ? pixels : 0, 0.0);
  terms.eta_jacobian.assign(derivatives ? pixels * columns : 0, 0.0);
  terms.repeat_factor.assign(recorded_.repeat_share.empty() ? 0 : pixels, 1.0);
  thread_local Sums sums;
  thread_local std::vector<std::uint32_t> counted;
  counted.clear();
  for (std::size_t pixel = first_pixel; pixel < first_pixel + pixels; ++pixel) {
    if (Counts(pixel)) counted.push_back(static_cast<std::uint32_t>(pixel));
  }
  for (std::size_t i = 0; i < counted.size(); i += pixel_math::kPixelsAtOnce) {
    const auto some = std::span<const std::uint32_t>(counted).subspan(
        i, std::min(pixel_math::kPixelsAtOnce, counted.size() - i));
    if (!SumEchoes(some, sums)) return false;
    FillLikelihood(some, sums.mean, first_pixel, terms);
    if (derivatives) FillJacobian(some, sums, first_pixel, terms.eta_jacobian.data());
  }
  return true;
}

std::vector<double> AcousticEvaluation::Means() const {
  std::vector<std::uint32_t> all(static_cast<std::size_t>(bins_) * beams_);
  std::iota(all.begin(), all.end(), 0U);
  Sums sums;
  SumEchoes(all, sums);
  return std::move(sums.mean);
}

}  // namespace sonarcal::calib
