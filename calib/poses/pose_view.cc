#include "calib/poses/pose_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/smoothing.h"
#include "sim/acoustic/acoustic_image.h"
#include "sim/physics/display.h"

namespace sonarcal::calib {

PoseView::PoseView(const AcousticFrameModel& model, int frame, const ParameterSet& parameters,
                   const PoseSmoothing& smoothing, const Rays& rays, const Pose& about)
    : model_(model),
      frame_(frame),
      parameters_(parameters),
      smoothing_(smoothing),
      pixels_per_cell_(model.speckle_cell().pixels()),
      lowest_(sim::PowerFromDisplay(parameters.display, 0.0)),
      highest_(sim::PowerFromDisplay(parameters.display, 1.0)) {
  if (smoothing.none()) return;
  shown_ = Grid<float>(model.range_bins(), model.beams());
  const std::vector<RecordedPower>& recorded = model.frame(frame).recorded;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    shown_.values()[i] =
        static_cast<float>(std::clamp(sim::DisplayValue(parameters.display, recorded[i].power), 0.0, 1.0));
  }
  const Grid<float> expected = ExpectedShown(PowerFrom(about, rays));
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    if (!Counts(i)) continue;
    const double weight = model_.Weight(frame_, i);
    squares += weight * std::pow(shown_.values()[i] - expected.values()[i], 2);
    count += weight;
  }
  weight_ = squares > 0.0 ? count / (squares * pixels_per_cell_) : 0.0;
}

Grid<float> PoseView::PowerFrom(const Pose& world_from_sonar, const Rays& rays) const {
  return model_.ExpectedPowerFrom(frame_, world_from_sonar, parameters_, rays).value;
}

Grid<float> PoseView::ExpectedShown(const Grid<float>& power) const {
  const PolarImage image{
      model_.sonar().axes,
      {.quantity = Quantity::kPower, .full_scale = 1.0, .db_min = {}, .db_max = {}, .db_span = {}},
      power};
  return sim::ExpectedDisplay(image, parameters_, 1.0).value;
}

Eigen::VectorXf PoseView::Expected(const Grid<float>& power) const {
  if (smoothing_.none()) {
    return Eigen::Map<const Eigen::ArrayXf>(power.values().data(), static_cast<Eigen::Index>(power.size()))
        .max(std::numeric_limits<float>::min())
        .log()
        .matrix();
  }
  Grid<float> shown = ExpectedShown(power);
  // The difference at unused pixels is 0.
  for (std::size_t i = 0; i < shown.size(); ++i) {
    shown.values()[i] = Counts(i) ? shown.values()[i] - shown_.values()[i] : 0.0F;
  }
  Smooth(shown, smoothing_.bins, smoothing_.beams);
  return Eigen::Map<const Eigen::VectorXf>(shown.values().data(), static_cast<Eigen::Index>(shown.size()));
}

Eigen::MatrixXf PoseView::Slopes(const Grid<double>& echoes, std::span<const Grid<float>> changes) const {
  constexpr float kStep = 1e-3F;
  Grid<double> total = echoes;
  sim::AddNoiseFloor({model_.sonar_at_point(), model_.simulator().absorption_db_per_m()}, parameters_, total);
  // Change of the expected value per relative change of the power.
  Eigen::ArrayXf of_power = Eigen::ArrayXf::Ones(static_cast<Eigen::Index>(total.size()));
  if (!smoothing_.none()) {
    const auto shown = [&](float factor) {
      Grid<float> power(total.rows(), total.cols());
      std::ranges::transform(total.values(), power.values().begin(),
                             [&](double value) { return factor * static_cast<float>(value); });
      return ExpectedShown(power);
    };
    const Grid<float> above = shown(1.0F + kStep);
    const Grid<float> below = shown(1.0F - kStep);
    for (std::size_t i = 0; i < total.size(); ++i) {
      of_power(static_cast<Eigen::Index>(i)) =
          Counts(i) ? (above.values()[i] - below.values()[i]) / (2.0F * kStep) : 0.0F;
    }
  }
  Eigen::MatrixXf slopes(of_power.size(), static_cast<Eigen::Index>(changes.size()));
  for (std::size_t k = 0; k < changes.size(); ++k) {
    Grid<float> change = changes[k];
    for (std::size_t i = 0; i < change.size(); ++i)
      change.values()[i] *= of_power(static_cast<Eigen::Index>(i)) / static_cast<float>(total.values()[i]);
    if (!smoothing_.none()) Smooth(change, smoothing_.bins, smoothing_.beams);
    slopes.col(static_cast<Eigen::Index>(k)) =
        Eigen::Map<const Eigen::VectorXf>(change.values().data(), of_power.size());
  }
  return slopes;
}

PoseView::Evaluation PoseView::Evaluate(const Eigen::VectorXf& expected) const {
  const Eigen::Index pixels = expected.size();
  if (!smoothing_.none()) {
    const Eigen::VectorXd difference = expected.cast<double>();
    const Eigen::VectorXd weight = Eigen::VectorXd::NullaryExpr(
        pixels, [&](Eigen::Index i) { return weight_ * model_.Weight(frame_, static_cast<std::size_t>(i)); });
    const Eigen::VectorXd score = -weight.cwiseProduct(difference);
    return {.cost = -0.5 * score.dot(difference), .score = score, .information = weight};
  }
  Evaluation evaluated{
      .cost = 0.0, .score = Eigen::VectorXd::Zero(pixels), .information = Eigen::VectorXd::Zero(pixels)};
  const AcousticFrame& frame = model_.frame(frame_);
  const double looks = parameters_.receiver.looks;
  for (Eigen::Index i = 0; i < pixels; ++i) {
    if (!Counts(static_cast<std::size_t>(i))) continue;
    const double mean = std::exp(static_cast<double>(expected[i]));
    const double weight = model_.Weight(frame_, static_cast<std::size_t>(i)) / pixels_per_cell_;
    const LikelihoodTerm term = PowerLikelihood(frame.recorded[i], mean, looks);
    evaluated.cost += 0.5 * weight * term.residual * term.residual;
    evaluated.score[i] = -weight * term.residual * term.slope;
    evaluated.information[i] = weight * ExpectedInformation(lowest_, highest_, mean, looks);
  }
  return evaluated;
}

}  // namespace sonarcal::calib
