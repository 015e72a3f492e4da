#include "calib/poses/pose_problem.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include "calib/parameters/placement_steps.h"

namespace sonarcal::calib {
namespace {

// Predicted fall of the cost below which no step is tried: a tenth of the effect of noise on one parameter.
constexpr double kSettledNats = 0.05;

}  // namespace

PoseStep NearestTurns(PoseStep named, const PoseStep& near) {
  constexpr double kTurnDeg = 360.0;
  for (int k = 3; k < kPoseSteps; ++k) named(k) += kTurnDeg * std::round((near(k) - named(k)) / kTurnDeg);
  return named;
}

PoseProblem::PoseProblem(const AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
                         const PoseSmoothing& smoothing, int decimation, std::vector<int> frames,
                         std::vector<int> entries, const ParameterValues& values)
    : model_(model),
      catalog_(catalog),
      entries_(std::move(entries)),
      frames_(std::move(frames)),
      decimation_(decimation) {
  std::ranges::copy_if(entries_, std::back_inserter(common_),
                       [&](int entry) { return catalog[entry].group != ParameterGroup::kPose; });
  const ParameterSet parameters = model.Parameters(values);
  const PoseView::Rays rays = model.RaysAt(values, decimation);
  for (const int frame : frames_)
    views_.emplace_back(model, frame, parameters, smoothing, rays, model.PoseOf(frame, values));
}

PoseProblem::State PoseProblem::At(const ParameterValues& values) const {
  State state{.values = values, .evaluated = std::vector<PoseView::Evaluation>(frames_.size()), .cost = 0.0};
  const PoseView::Rays rays = model_.RaysAt(values, decimation_);
  tbb::parallel_for(std::size_t{0}, frames_.size(), [&](std::size_t i) {
    state.evaluated[i] = views_[i].Evaluate(views_[i].Expected(model_.PoseOf(frames_[i], values), rays));
  });
  for (const PoseView::Evaluation& evaluated : state.evaluated) state.cost += evaluated.cost;
  state.cost += CostOfPriors(catalog_, entries_, values);
  return state;
}

PoseProblem::Slopes PoseProblem::SlopesAt(const ParameterValues& values) const {
  const auto columns = static_cast<Eigen::Index>(kPoseSteps + common_.size());
  Slopes slopes(frames_.size());
  const std::shared_ptr<const sim::Simulator> simulator = model_.SimulatorAt(values);
  const PolarAxes& axes = model_.sonar().axes;
  const bool objects = std::ranges::any_of(common_, [&](int entry) { return IsRigidMove(catalog_[entry]); });
  tbb::parallel_for(std::size_t{0}, frames_.size(), [&](std::size_t i) {
    const Pose pose = model_.PoseOf(frames_[i], values);
    const MoveSlopes moves = model_.SlopesFrom(*simulator, pose, values, objects);
    std::vector<Grid<float>> changes(moves.along.begin(), moves.along.end());
    changes.push_back(moves.range_offset);
    std::vector<std::size_t> change_of(common_.size());  // column of `changes`
    for (std::size_t k = 0; k < common_.size(); ++k) {
      const CatalogEntry& entry = catalog_[common_[k]];
      change_of[k] = TurnsBeams(entry) ? kTurnOfSonar : kPoseSteps;
      if (!IsRigidMove(entry)) continue;
      change_of[k] = changes.size();
      changes.push_back(model_.SlopeAlongObject(moves, common_[k], pose, values));
    }
    const Eigen::MatrixXf of_changes = views_[i].Slopes(moves.power, changes);
    slopes[i].resize(of_changes.rows(), columns);
    slopes[i].leftCols(kPoseSteps) = of_changes.leftCols(kPoseSteps);
    for (std::size_t k = 0; k < common_.size(); ++k) {
      const CatalogEntry& entry = catalog_[common_[k]];
      if (!ChangesAxes(entry) && !IsRigidMove(entry)) continue;
      auto column = slopes[i].col(static_cast<Eigen::Index>(kPoseSteps + k));
      column = (TurnsBeams(entry) ? -1.0F : 1.0F) * of_changes.col(static_cast<Eigen::Index>(change_of[k]));
      if (ChangesAxes(entry))
        ScaleToEntry(axes, entry, {column.data(), static_cast<std::size_t>(column.size())});
    }
  });
  AddSlopesOfScene(values, slopes);
  return slopes;
}

// Slopes along placements that change the scene, or turn the sonar at its mount.
void PoseProblem::AddSlopesOfScene(const ParameterValues& values, Slopes& slopes) const {
  for (std::size_t k = 0; k < common_.size(); ++k) {
    const CatalogEntry& entry = catalog_[common_[k]];
    if (ChangesAxes(entry) || IsRigidMove(entry)) continue;
    const double step = PlacementDifference(model_.sonar().axes, entry);
    ParameterValues above = values;
    ParameterValues below = values;
    above[common_[k]] += step;
    below[common_[k]] -= step;
    const PoseView::Rays rays_above = model_.RaysAt(above, decimation_);
    const PoseView::Rays rays_below = model_.RaysAt(below, decimation_);
    tbb::parallel_for(std::size_t{0}, frames_.size(), [&](std::size_t i) {
      slopes[i].col(static_cast<Eigen::Index>(kPoseSteps + k)) =
          (views_[i].Expected(model_.PoseOf(frames_[i], above), rays_above) -
           views_[i].Expected(model_.PoseOf(frames_[i], below), rays_below)) /
          static_cast<float>(2.0 * step);
    });
  }
}

QuadraticCost PoseProblem::OfFrames(const State& state, const Slopes& slopes) const {
  const auto count = static_cast<Eigen::Index>(entries_.size());
  QuadraticCost normal{Eigen::MatrixXd::Zero(count, count), Eigen::VectorXd::Zero(count)};
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const PoseView::Evaluation& evaluated = state.evaluated[i];
    const Eigen::MatrixXd slope = slopes[i].cast<double>();
    const Eigen::MatrixXd moves = MovesOfEntries(frames_[i], state.values);
    normal.information +=
        moves.transpose() * (slope.transpose() * evaluated.information.asDiagonal() * slope) * moves;
    normal.score += moves.transpose() * (slope.transpose() * evaluated.score);
  }
  return normal;
}

Eigen::VectorXd PoseProblem::PriorSigmas() const {
  Eigen::VectorXd sigma(static_cast<Eigen::Index>(entries_.size()));
  for (std::size_t k = 0; k < entries_.size(); ++k) {
    sigma(static_cast<Eigen::Index>(k)) = catalog_[entries_[k]].StepSigma();
  }
  return sigma;
}

void PoseProblem::AddPriors(const ParameterValues& values, QuadraticCost& normal) const {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto& prior = catalog_[entries_[i]].prior;
    if (!prior) continue;
    normal.information(k, k) += 1.0 / (prior->sigma * prior->sigma);
    normal.score(k) -= catalog_[entries_[i]].FromPrior(values[entries_[i]]) / prior->sigma;
  }
}

QuadraticCost PoseProblem::NormalAt(const State& state, const Slopes& slopes) const {
  QuadraticCost normal = OfFrames(state, slopes);
  AddPriors(state.values, normal);
  return normal;
}

double PoseProblem::Step(const Slopes& slopes, double& damping, State& state) const {
  const auto trial_at = [&](const Eigen::VectorXd& step) { return At(MovedEntries(state.values, step)); };
  // Priors alone count along directions that the frames do not determine, as in joint steps.
  QuadraticCost normal = OfFrames(state, slopes);
  const Eigen::VectorXd sigma = PriorSigmas();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(sigma.asDiagonal() * normal.information *
                                                             sigma.asDiagonal());
  const Eigen::VectorXd told = (eigen.eigenvalues().array() >= 1.0 / kOpenShare).cast<double>();
  const Eigen::MatrixXd kept = sigma.cwiseInverse().asDiagonal() * eigen.eigenvectors() * told.asDiagonal();
  const Eigen::MatrixXd in_sigmas = eigen.eigenvectors().transpose() * sigma.asDiagonal();
  normal.score = kept * (in_sigmas * normal.score);
  normal.information = kept * eigen.eigenvalues().asDiagonal() * kept.transpose();
  AddPriors(state.values, normal);
  return DampedStep(normal, kSettledNats, trial_at, damping, state);
}

Eigen::VectorXd PoseProblem::Ridge(const State& state, const Slopes& slopes) const {
  const Eigen::VectorXd sigma = PriorSigmas();
  const Eigen::MatrixXd in_sigmas =
      sigma.asDiagonal() * NormalAt(state, slopes).information * sigma.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(in_sigmas);
  return sigma.cwiseProduct(eigen.eigenvectors().col(0));
}

ParameterValues PoseProblem::MovedEntries(const ParameterValues& values, const Eigen::VectorXd& by) const {
  ParameterValues moved = values;
  for (std::size_t k = 0; k < entries_.size(); ++k)
    Set(entries_[k], values[entries_[k]] + by(static_cast<Eigen::Index>(k)), moved);
  return moved;
}

ParameterValues PoseProblem::MovedSonar(const ParameterValues& values, const PoseStep& by) const {
  PoseStep named;
  for (const int entry : entries_) named(catalog_[entry].index) = values[entry];
  named = NearestTurns(NamedValues(MovePose(PoseFromNamedValues(named), by)), named);
  ParameterValues moved = values;
  for (const int entry : entries_) Set(entry, named(catalog_[entry].index), moved);
  return moved;
}

int PoseProblem::EntryOf(int component) const {
  if (entries_.size() != kPoseSteps) return -1;
  for (const int entry : entries_) {
    if (catalog_[entry].index == component) return entry;
  }
  return -1;
}

Eigen::MatrixXd PoseProblem::MovesOfEntries(int frame, const ParameterValues& values) const {
  constexpr double kDifference = 1e-5;
  const Pose pose = model_.PoseOf(frame, values);
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(kPoseSteps + common_.size()),
                                                static_cast<Eigen::Index>(entries_.size()));
  std::size_t common = 0;
  for (std::size_t k = 0; k < entries_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    if (catalog_[entries_[k]].group != ParameterGroup::kPose) {
      moves(static_cast<Eigen::Index>(kPoseSteps + common++), column) = 1.0;
      continue;
    }
    ParameterValues at = values;
    at[entries_[k]] += kDifference;
    moves.col(column).head<kPoseSteps>() = StepBetween(pose, model_.PoseOf(frame, at)) / kDifference;
  }
  return moves;
}

void PoseProblem::Set(int entry, double value, ParameterValues& values) const {
  values[entry] = std::clamp(value, catalog_[entry].lower, catalog_[entry].upper);
}

}  // namespace sonarcal::calib
