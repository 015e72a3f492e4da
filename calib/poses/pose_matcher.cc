#include "calib/poses/pose_matcher.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/smoothing.h"
#include "core/types/units.h"
#include "sim/acoustic/acoustic_frame.h"

namespace sonarcal::calib {
namespace {

// Coordinates of a step: range, azimuth, elevation, turn about the body's x, y, z, gain, gain of the floor.
constexpr int kElevation = 2;
constexpr int kTurn = 3;
constexpr int kGain = 6;
constexpr int kFloorGain = 7;
// Differences must span a few rays, otherwise they show the effect of single rays at edges.
constexpr double kDifference = 0.3;  // steps
constexpr double kFirstDamping = 1e-2;
constexpr double kMaxDamping = 1e4;
constexpr double kConverged = 1e-5;  // relative fall of the cost

// Mean over groups of range bins of a box, scaled by `scale`.
Grid<float> FewerBins(const Grid<float>& image, const ImageBox& box, int factor, double scale) {
  Grid<float> out((box.last_bin - box.first_bin) / factor, box.last_beam - box.first_beam);
  for (int row = 0; row < out.rows(); ++row) {
    for (int col = 0; col < out.cols(); ++col) {
      double sum = 0.0;
      for (int i = 0; i < factor; ++i) sum += image(box.first_bin + row * factor + i, box.first_beam + col);
      out(row, col) = static_cast<float>(sum / factor * scale);
    }
  }
  return out;
}

SonarModel Cropped(const SonarModel& sonar, const ImageBox& box, int factor) {
  SonarModel cropped = sonar;
  const PolarAxes& axes = sonar.axes;
  cropped.axes.range_bins = (box.last_bin - box.first_bin) / factor;
  cropped.axes.range_min_m = axes.range_edge_m(box.first_bin);
  cropped.axes.range_max_m = axes.range_edge_m(box.first_bin + cropped.axes.range_bins * factor);
  const auto first = axes.beam_azimuth_rad.begin();
  cropped.axes.beam_azimuth_rad.assign(first + box.first_beam, first + box.last_beam);
  return cropped;
}

void CropPerBeam(const ImageBox& box, std::vector<double>& per_beam) {
  if (per_beam.empty()) return;
  per_beam = std::vector<double>(per_beam.begin() + box.first_beam, per_beam.begin() + box.last_beam);
}

ParameterSet Silent(ParameterSet parameters, const std::vector<std::string>& materials) {
  for (const std::string& name : materials) {
    parameters.materials[name] = parameters.Material(name);
    GsabParameters<double>& gsab = parameters.materials[name].gsab;
    gsab.a = gsab.c = gsab.e = 0.0;
  }
  return parameters;
}

void Hold(int coordinate, QuadraticCost& normal) {
  normal.information.row(coordinate).setZero();
  normal.information.col(coordinate).setZero();
  normal.information(coordinate, coordinate) = 1.0;
  normal.score(coordinate) = 0.0;
}

}  // namespace

TargetPose MatchState::AsTargetPose() const {
  TargetPose pose = TargetPose::Of({rotation, Eigen::Vector3d::UnitY()});
  pose.range_m = place(0);
  pose.azimuth_rad = place(1);
  pose.elevation_rad = place(2);
  return pose;
}

MatchState StateAt(const Pose& sonar_from_body) {
  const TargetPose pose = TargetPose::Of(sonar_from_body);
  return {.place = {pose.range_m, pose.azimuth_rad, pose.elevation_rad},
          .rotation = sonar_from_body.rotation};
}

PoseMatcher::PoseMatcher(std::shared_ptr<const sim::RayCaster> caster, const SonarModel& sonar,
                         const Water& water, const PolarImage& measured, const ParameterSet& parameters,
                         const MeshSymmetry& symmetry, const PoseSearchOptions& options, const ImageBox& box,
                         const PlaceBounds& bounds, int max_factor)
    : options_(options),
      factor_(std::clamp(max_factor, 1, std::max(1, box.last_bin - box.first_bin))),
      body_from_mesh_(symmetry.mesh_from_body.Inverse()),
      parameters_(parameters),
      bounds_(bounds) {
  const int factor = factor_;
  const SonarModel coarse = Cropped(sonar, box, factor);
  // The pulse is at least one bin long.
  parameters_.pulse.length_m = std::max(parameters_.pulse.length_m, coarse.axes.range_bin_m());
  CropPerBeam(box, parameters_.receiver.noise_taper_db);
  CropPerBeam(box, parameters_.receiver.noise_after_gain_taper_db);
  CropPerBeam(box, parameters_.beam.sensitivity_db);
  if (!options.floor_material.empty()) {
    std::vector<std::string> others = caster->material_names();
    std::erase(others, options.floor_material);
    of_target_ = Silent(parameters_, {options.floor_material});
    of_floor_ = Silent(parameters_, others);
  }
  sim::SimulationOptions simulation;
  simulation.water = water;
  simulation.fan = {
      .sampling = sim::Sampling::kBeams,
      .cols = coarse.axes.beam_count() * std::max(1, options.cols_per_beam / factor),
      .rows = static_cast<int>(std::ceil(options.elevation_span_deg / options.ray_height_deg / factor)),
      .elevation_span_deg = options.elevation_span_deg,
      .stagger = true,
      .stagger_rows = true};
  simulator_ = std::make_unique<sim::Simulator>(std::move(caster), coarse, simulation);
  noise_ = sim::NoiseFloorPower(geometry(), parameters_);
  mean_display_.emplace(parameters_.display, parameters_.receiver.looks);
  measured_ = FewerBins(measured.value, box, factor, 1.0 / measured.scale.full_scale);
  Smooth(measured_, options.smooth_bins / factor, options.smooth_beams);
  weight_ = Grid<float>(measured_.rows(), measured_.cols(), 1.0F);
  if (!options.pixels.empty()) {
    Grid<float> counted(options.pixels.rows(), options.pixels.cols());
    std::copy(options.pixels.values().begin(), options.pixels.values().end(), counted.values().begin());
    weight_ = FewerBins(counted, box, factor, 1.0);
  }
  for (const float weight : weight_.values()) weight_sum_ += weight;

  const double range_step_m = 7.0 * sonar.axes.range_bin_m();
  const double turn_rad = std::clamp(2.5 * range_step_m / symmetry.radius_m, 0.02, 0.15);
  unit_ << range_step_m, 2.5 * sonar.axes.beam_spacing_rad(), 0.05, turn_rad, turn_rad, turn_rad, 1.0, 1.0;
  const bool has_floor = of_floor_.has_value();
  held_[kFloorGain] = !has_floor;
  if (!has_floor) {
    held_[kTurn] = symmetry.revolution != Revolution::kNone;
    held_[kTurn + 1] = held_[kTurn + 2] = symmetry.revolution == Revolution::kSphere;
  }
  const Grid<double> none(measured_.rows(), measured_.cols());
  const Grid<float> silent = Displayed({none, {}}, 0.0, 0.0);
  for (const float value : silent.values()) noise_value_ += value / static_cast<double>(silent.size());
}

EchoPowers PoseMatcher::Echoes(const Pose& sonar_from_body) const {
  if (options_.stop && options_.stop()) throw PoseSearchStopped();
  const Pose world_from_sonar = (sonar_from_body * body_from_mesh_).Inverse();
  const auto power = [&](const ParameterSet& parameters) {
    return sim::EchoPowerImage(sim::CastScatterMap(simulator_->caster(), simulator_->fan(), world_from_sonar,
                                                   geometry(), parameters),
                               geometry(), parameters);
  };
  if (!of_floor_) return {power(parameters_), {}};
  return {power(*of_target_), power(*of_floor_)};
}

Grid<float> PoseMatcher::Displayed(const EchoPowers& echoes, double gain_db, double floor_gain_db) const {
  const double gain = PowerFromDb(gain_db);
  const double floor_gain = PowerFromDb(floor_gain_db);
  Grid<float> shown(noise_.rows(), noise_.cols());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    double power = noise_.values()[i] + gain * echoes.target.values()[i];
    if (!echoes.floor.empty()) power += floor_gain * echoes.floor.values()[i];
    shown.values()[i] = static_cast<float>((*mean_display_)(power));
  }
  Smooth(shown, options_.smooth_bins / factor_, options_.smooth_beams);
  return shown;
}

double PoseMatcher::Cost(const Grid<float>& predicted) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const double difference = predicted.values()[i] - measured_.values()[i];
    sum += weight_.values()[i] * difference * difference;
  }
  return sum / weight_sum_;
}

void PoseMatcher::Evaluate(MatchState& state) const {
  state.predicted = Displayed(Echoes(state.SonarFromBody()), state.gain_db, state.floor_gain_db);
  state.cost = Cost(state.predicted);
}

void PoseMatcher::TakeBestGain(MatchState& state, double reach_db) const {
  const EchoPowers echoes = Echoes(state.SonarFromBody());
  const auto take_best = [&](double MatchState::*gain) {
    const double about_db = state.*gain;
    double best_db = about_db;
    state.cost = std::numeric_limits<double>::infinity();
    constexpr double kStepDb = 5.0;
    const auto steps = static_cast<int>(reach_db / kStepDb);
    for (int step = -steps; step <= steps; ++step) {
      const double db = about_db + kStepDb * step;
      state.*gain = db;
      Grid<float> predicted = Displayed(echoes, state.gain_db, state.floor_gain_db);
      const double cost = Cost(predicted);
      if (!(cost < state.cost)) continue;
      best_db = db;
      state.cost = cost;
      state.predicted = std::move(predicted);
    }
    state.*gain = best_db;
  };
  if (of_floor_) take_best(&MatchState::floor_gain_db);
  take_best(&MatchState::gain_db);
}

std::optional<Eigen::Vector2d> PoseMatcher::MiddleOf(const Grid<float>& image, double threshold) const {
  double weight = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int row = 0; row < image.rows(); ++row) {
    for (int col = 0; col < image.cols(); ++col) {
      const double excess = image(row, col) - threshold;
      if (excess <= 0.0 || weight_(row, col) <= 0.0F) continue;
      weight += excess;
      sum += excess * Eigen::Vector2d(axes().range_centre_m(row), axes().beam_azimuth_rad[col]);
    }
  }
  if (!(weight > 0.0)) return std::nullopt;
  return sum / weight;
}

void PoseMatcher::TakeBestPlace(MatchState& state) const {
  const double peak = *std::max_element(measured_.values().begin(), measured_.values().end());
  const double threshold = noise_value_ + 0.25 * std::max(0.0, peak - noise_value_);
  const auto recorded = MiddleOf(measured_, threshold);
  const auto predicted = MiddleOf(state.predicted, threshold);
  if (!recorded || !predicted) return;
  state.place.head<2>() += *recorded - *predicted;
  const auto [lower, upper] = PlaceLimits();
  state.place = state.place.cwiseMax(lower).cwiseMin(upper);
}

std::pair<Eigen::Vector3d, Eigen::Vector3d> PoseMatcher::PlaceLimits() const {
  return {{bounds_.range_m.low, bounds_.azimuth_rad.low, bounds_.elevation_rad.low},
          {bounds_.range_m.high, bounds_.azimuth_rad.high, bounds_.elevation_rad.high}};
}

MatchState PoseMatcher::Moved(const MatchState& from, const Eigen::VectorXd& step) const {
  const Step by = Step(step).cwiseProduct(unit_);
  const auto [lower, upper] = PlaceLimits();
  const Eigen::Vector3d turn = by.segment<3>(kTurn);
  const double angle_rad = turn.norm();
  MatchState moved{.place = (from.place + by.head<3>()).cwiseMax(lower).cwiseMin(upper),
                   .rotation = from.rotation,
                   .gain_db = from.gain_db + by(kGain),
                   .floor_gain_db = from.floor_gain_db + by(kFloorGain)};
  if (angle_rad > 0.0)
    moved.rotation = (from.rotation * Eigen::AngleAxisd(angle_rad, turn / angle_rad)).normalized();
  Evaluate(moved);
  return moved;
}

QuadraticCost PoseMatcher::NormalAt(const MatchState& state) const {
  const auto pixels = static_cast<Eigen::Index>(measured_.size());
  const auto image = [pixels](const Grid<float>& grid) {
    return Eigen::Map<const Eigen::VectorXf>(grid.values().data(), pixels).cast<double>();
  };
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(pixels, kCoordinates);
  for (int k = 0; k < kCoordinates; ++k) {
    if (held_.at(k)) continue;
    const Eigen::VectorXd move = kDifference * Step::Unit(k);
    slopes.col(k) =
        (image(Moved(state, move).predicted) - image(Moved(state, -move).predicted)) / (2.0 * kDifference);
  }
  const Eigen::VectorXd weight = image(weight_);
  const Eigen::MatrixXd weighted = weight.asDiagonal() * slopes;
  QuadraticCost normal{slopes.transpose() * weighted,
                       weighted.transpose() * (image(measured_) - image(state.predicted))};
  for (int k = 0; k < kCoordinates; ++k) {
    // A coordinate without any effect must not make the equations singular.
    if (held_.at(k) || !(normal.information(k, k) > 0.0)) Hold(k, normal);
  }
  return normal;
}

void PoseMatcher::Refine(MatchState& state, int max_iterations, bool hold_elevation) const {
  const auto [lower, upper] = PlaceLimits();
  if (!hold_elevation) state.place = state.place.cwiseMax(lower).cwiseMin(upper);
  Evaluate(state);
  double damping = kFirstDamping;
  for (int i = 0; i < max_iterations; ++i) {
    QuadraticCost normal = NormalAt(state);
    if (hold_elevation) Hold(kElevation, normal);
    for (int k = 0; k < 3; ++k) {
      if ((state.place(k) <= lower(k) && normal.score(k) < 0.0) ||
          (state.place(k) >= upper(k) && normal.score(k) > 0.0))
        Hold(k, normal);
    }
    double fall = 0.0;
    while (fall == 0.0 && damping < kMaxDamping) {
      fall = DampedStep(
          normal, 0.0, [&](const Eigen::VectorXd& step) { return Moved(state, step); }, damping, state);
    }
    if (fall <= kConverged * state.cost) break;
  }
}

std::vector<std::string> PoseMatcher::AtBounds(const MatchState& state) const {
  const auto [lower, upper] = PlaceLimits();
  constexpr std::array kNames = {"range", "azimuth", "elevation"};
  std::vector<std::string> sentences;
  for (int k = 0; k < 3; ++k) {
    const double slack = 0.02 * unit_(k);
    const bool low = state.place(k) <= lower(k) + slack;
    if (!low && state.place(k) < upper(k) - slack) continue;
    const std::string value = k == 0 ? fmt::format("{:.3f} m", state.place(k))
                                     : fmt::format("{:.2f} deg", DegFromRad(state.place(k)));
    sentences.push_back(fmt::format(
        "the search ended at the {} bound of the {} ({}): the pose may lie beyond it, or the mesh, the floor "
        "or the backscatter curve does not describe the target",
        low ? "lower" : "upper", kNames.at(k), value));
  }
  return sentences;
}

PoseMatcher::Comparison PoseMatcher::Compare(const MatchState& best, const MatchState& other) const {
  // Effective area of a Gaussian kernel, sqrt(4 pi) times its standard deviation both ways.
  const double cell_bins = std::max(1.0, std::sqrt(4.0 * kPi) * options_.smooth_bins / factor_);
  const double cell_beams = std::max(1.0, std::sqrt(4.0 * kPi) * options_.smooth_beams);
  const int block_bins = static_cast<int>(std::ceil(3.0 * cell_bins));
  const int block_beams = static_cast<int>(std::ceil(3.0 * cell_beams));
  const int across = (measured_.cols() + block_beams - 1) / block_beams;
  std::vector<double> blocks(static_cast<std::size_t>(across) *
                             ((measured_.rows() + block_bins - 1) / block_bins));
  for (int row = 0; row < measured_.rows(); ++row) {
    for (int col = 0; col < measured_.cols(); ++col) {
      const double of_best = best.predicted(row, col) - measured_(row, col);
      const double of_other = other.predicted(row, col) - measured_(row, col);
      blocks[static_cast<std::size_t>(row / block_bins) * across + col / block_beams] +=
          weight_(row, col) * (of_other * of_other - of_best * of_best);
    }
  }
  double sum = 0.0;
  double squares = 0.0;
  for (const double block : blocks) {
    sum += block;
    squares += block * block;
  }
  if (!(squares > 0.0)) return {};
  return {.nats = 0.5 * sum / (best.cost * cell_bins * cell_beams), .sigmas = sum / std::sqrt(squares)};
}

}  // namespace sonarcal::calib
