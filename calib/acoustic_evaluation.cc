#include "calib/acoustic_evaluation.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data_io/types/error.h"
#include "data_io/types/units.h"
#include "sim/physics/display.h"
#include "sim/physics/gsab.h"

namespace sonarcal {
namespace {

constexpr double kNeperPerDb = std::numbers::ln10 / 10.0;
constexpr double kMostGrowth = 3.0;  // of an echo, by a move that a slope can speak for; nepers of power

std::vector<double> TabulateCurves(const ParameterSet& parameters, const std::vector<std::string>& names) {
  using Dual = ceres::Jet<double, kCurveTerms - 1>;
  const std::vector<double>& nodes_deg = CoarseIncidenceDeg();
  std::vector<double> table(names.size() * nodes_deg.size() * kCurveStride, 0.0);
  double* at = table.data();
  for (const std::string& name : names) {
    const GsabParameters<double>& g = parameters.materials.at(name).gsab;
    const GsabParameters<Dual> gsab = {Dual(g.a, 0), Dual(g.b_deg, 1), Dual(g.c, 2),
                                       Dual(g.d, 3), Dual(g.e, 4),     Dual(g.f_deg, 5)};
    for (const double node_deg : nodes_deg) {
      const Dual power = GsabPower(gsab, node_deg);
      at[0] = power.a;
      std::copy(power.v.begin(), power.v.end(), at + 1);
      at += kCurveStride;
    }
  }
  return table;
}

}  // namespace

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
      noise_(state.parameters.receiver, state.sonar.axes, state.absorption_db_per_m),
      looks_(state.parameters.receiver.looks),
      lowest_(PowerFromDisplay(state.parameters.display, 0.0)),
      highest_(PowerFromDisplay(state.parameters.display, 1.0)) {
  for (const int entry : active) columns_.push_back(PlanColumn(state, entry));
  for (const EchoSlope& slope : echoes.slopes)
    moved_.push_back(state.values[slope.entry] - state.point[slope.entry]);
  const ReceiverParameters& receiver = state.parameters.receiver;
  for (int bin = 0; bin < bins_; ++bin) {
    range_m_.push_back(state.sonar.axes.range_centre_m(bin));
    gain_.push_back(
        PowerFromDb(state.parameters.source_level_db + receiver.gain_db +
                    TimeVariedGainDb(receiver.time_varied_gain, range_m_.back(), state.absorption_db_per_m)));
  }
}

AcousticEvaluation::Column AcousticEvaluation::PlanColumn(const AcousticState& state, int entry) const {
  const CatalogEntry& of = state.catalog[entry];
  if (IsGeometric(of)) {
    const auto found = std::find_if(echoes_.slopes.begin(), echoes_.slopes.end(),
                                    [entry](const EchoSlope& slope) { return slope.entry == entry; });
    if (found == echoes_.slopes.end()) return {};
    return {Of::kGeometry, static_cast<int>(found - echoes_.slopes.begin())};
  }
  if (of.group == ParameterGroup::kGsab) return {Of::kCurve, of.material * kCurveStride + 1 + of.index};
  if (of.group == ParameterGroup::kReceiver && of.index == 1) return {Of::kNoise, 0};
  if (of.group == ParameterGroup::kReceiver && of.index == 2) return {Of::kNoiseSlope, 0};
  return {Of::kLevel, 0};  // gain and source level
}

AcousticEvaluation::Sums AcousticEvaluation::MakeSums() const {
  const std::size_t terms = materials_ * kCurveStride;
  return {.curves = std::vector<double>(terms),
          .slopes = std::vector<double>(moved_.size()),
          .scratch = std::vector<double>(moved_.empty() ? 0 : terms),
          .power = 0.0};
}

void AcousticEvaluation::SumEchoes(std::size_t pixel, Sums& sums) const {
  std::fill(sums.curves.begin(), sums.curves.end(), 0.0);
  AddCurves(echoes_.at_point, pixel, curves_, sums.curves);
  const auto all_materials = [this](const std::vector<double>& of) {
    double power = 0.0;
    for (std::size_t material = 0; material < materials_; ++material) power += of[material * kCurveStride];
    return power;
  };
  double grown = 0.0;  // by poses, in nepers
  for (std::size_t g = 0; g < moved_.size(); ++g) {
    if (wanted_ == FrameModel::Terms::kResiduals && moved_[g] == 0.0) continue;
    const EchoSlope& slope = echoes_.slopes[g];
    if (!slope.logarithm.empty()) {
      grown += moved_[g] * slope.logarithm[pixel];
      continue;
    }
    std::fill(sums.scratch.begin(), sums.scratch.end(), 0.0);
    AddCurves(slope.echoes, pixel, curves_, sums.scratch);
    sums.slopes[g] = all_materials(sums.scratch);
    for (std::size_t i = 0; i < sums.curves.size(); ++i) sums.curves[i] += moved_[g] * sums.scratch[i];
  }
  const double factor = grown == 0.0 ? 1.0 : std::exp(std::clamp(grown, -kMostGrowth, kMostGrowth));
  for (double& value : sums.curves) value *= factor;
  sums.power = all_materials(sums.curves);
  for (std::size_t g = 0; g < moved_.size(); ++g) {
    const EchoSlope& slope = echoes_.slopes[g];
    if (slope.logarithm.empty()) {
      sums.slopes[g] *= factor;
    } else {
      sums.slopes[g] = std::abs(grown) < kMostGrowth ? slope.logarithm[pixel] * sums.power : 0.0;
    }
  }
}

// d ln mean / d active values.
void AcousticEvaluation::FillRow(int bin, int beam, const Sums& sums, double mean, double* row) const {
  // Far from the point a linear echo may fall below nothing: then nothing is heard.
  const double of_echo = sums.power > 0.0 ? gain_[bin] / mean : 0.0;
  const double of_noise = kNeperPerDb * noise_.BeforeGain(bin, beam) / mean;
  for (const Column& column : columns_) {
    double slope = 0.0;
    switch (column.of) {
      case Of::kCurve:
        slope = of_echo * sums.curves[column.index];
        break;
      case Of::kGeometry:
        slope = of_echo * sums.slopes[column.index];
        break;
      case Of::kLevel:
        slope = kNeperPerDb * of_echo * sums.power;
        break;
      case Of::kNoise:
        slope = of_noise;
        break;
      case Of::kNoiseSlope:
        slope = of_noise * range_m_[bin];
        break;
      case Of::kNothing:
        break;
    }
    *row++ = slope;
  }
}

bool AcousticEvaluation::Bins(int first, int last, PixelTerms& terms) const {
  const std::size_t pixels = static_cast<std::size_t>(last - first) * beams_;
  const std::size_t columns = columns_.size();
  const bool derivatives = wanted_ != FrameModel::Terms::kResiduals;
  terms.residual.assign(pixels, 0.0);
  terms.slope.assign(derivatives ? pixels : 0, 0.0);
  terms.information.assign(wanted_ == FrameModel::Terms::kInformation ? pixels : 0, 0.0);
  terms.eta_jacobian.assign(derivatives ? pixels * columns : 0, 0.0);
  terms.repeat_factor.assign(recorded_.repeat_share.empty() ? 0 : pixels, 1.0);
  Sums sums = MakeSums();
  for (std::size_t i = 0; i < pixels; ++i) {
    const int bin = first + static_cast<int>(i) / beams_;
    const int beam = static_cast<int>(i) % beams_;
    const std::size_t pixel = static_cast<std::size_t>(first) * beams_ + i;
    if (!Counts(pixel)) continue;
    SumEchoes(pixel, sums);
    const double mean = gain_[bin] * std::max(sums.power, 0.0) + noise_.Power(bin, beam);
    if (!(mean > 0.0) || !std::isfinite(mean)) return false;
    const LikelihoodTerm term = PowerLikelihood(recorded_.power[pixel], mean, looks_);
    // Of a likelihood to the power of a weight: residual and slope by its root, information by it.
    const double share = recorded_.repeat_share.empty() ? 1.0 : recorded_.repeat_share[pixel];
    const double weight = share * (recorded_.weight.empty() ? 1.0 : recorded_.weight[pixel]);
    if (!recorded_.repeat_share.empty()) terms.repeat_factor[i] = std::sqrt(share);
    const double root = weight == 1.0 ? 1.0 : std::sqrt(weight);
    terms.residual[i] = root * term.residual;
    if (!derivatives) continue;
    terms.slope[i] = root * term.slope;
    if (wanted_ == FrameModel::Terms::kInformation)
      terms.information[i] = weight * ExpectedInformation(lowest_, highest_, mean, looks_);
    FillRow(bin, beam, sums, mean, &terms.eta_jacobian[i * columns]);
  }
  return true;
}

std::vector<double> AcousticEvaluation::Means() const {
  std::vector<double> means;
  means.reserve(static_cast<std::size_t>(bins_) * beams_);
  Sums sums = MakeSums();
  for (int bin = 0; bin < bins_; ++bin) {
    for (int beam = 0; beam < beams_; ++beam) {
      SumEchoes(means.size(), sums);
      means.push_back(gain_[bin] * std::max(sums.power, 0.0) + noise_.Power(bin, beam));
    }
  }
  return means;
}

}  // namespace sonarcal
