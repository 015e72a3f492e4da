#include "calib/pose_refinement.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "calib/pose_step.h"
#include "data_io/types/units.h"

namespace sonarcal {
namespace {

constexpr int kStepsOfSlopes = 3;
constexpr int kTries = 5;  // of the damping, at each step
constexpr double kFirstDamping = 1e-3;
// Fall of the cost below which nothing more is to be had: a hundredth of what noise moves one parameter by.
constexpr double kSettled = 0.005;

struct Normal {
  Eigen::MatrixXd information;
  Eigen::VectorXd score;
};

// Frames whose poses hang together, and the entries that decide them.
class PoseProblem {
 public:
  PoseProblem(const PoseProblem&) = delete;
  PoseProblem& operator=(const PoseProblem&) = delete;

  PoseProblem(const AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
              const PoseStage& stage, std::vector<int> frames, std::vector<int> entries,
              const ParameterValues& values)
      : model_(model),
        catalog_(catalog),
        entries_(std::move(entries)),
        frames_(std::move(frames)),
        fan_(model.ThinnedFan(stage.thin)) {
    const ParameterSet parameters = model.Parameters(values);
    for (const int frame : frames_) {
      views_.emplace_back(model, frame, parameters, stage.smoothing, fan_, model.PoseOf(frame, values));
    }
  }

  void Sweep(double step_m, double step_deg, ParameterValues& values) {
    State best = At(values);
    for (const int index : {5, 1}) {  // heading, distance
      const int entry = EntryOf(index);
      if (entry < 0 || !catalog_[entry].prior) continue;
      const double step = index == 5 ? step_deg : step_m;
      const int reach = static_cast<int>(std::min(4.0, 2.0 * catalog_[entry].prior->sigma / step));
      const ParameterValues from = best.values;
      for (int k = -reach; k <= reach; ++k) {
        if (k == 0) continue;
        PoseStep move = PoseStep::Zero();
        move(index) = k * step;
        State trial = At(Moved(from, move));
        if (trial.cost < best.cost) best = std::move(trial);
      }
    }
    values = best.values;
  }

  double Solve(int slope_rounds, bool along_ridge, ParameterValues& values) {
    State state = At(values);
    const double cost_initial = state.cost;
    double damping = kFirstDamping;
    for (int round = 0; round < slope_rounds; ++round) {
      const std::vector<Eigen::MatrixXf> slopes = SlopesAt(state.values);
      double fall = along_ridge && round == 0 ? TryAlongRidge(slopes, state) : 0.0;
      for (int step = 0; step < kStepsOfSlopes; ++step) {
        const double of_step = Step(slopes, damping, state);
        fall += of_step;
        if (of_step < kSettled) break;
      }
      if (fall < kSettled) break;
    }
    values = state.values;
    return cost_initial - state.cost;
  }

 private:
  struct State {
    ParameterValues values;
    std::vector<PoseView::Judgement> judged;  // by frame
    double cost = 0.0;
  };

  State At(const ParameterValues& values) const {
    State state{.values = values, .judged = std::vector<PoseView::Judgement>(frames_.size()), .cost = 0.0};
    tbb::parallel_for(std::size_t{0}, frames_.size(), [&](std::size_t i) {
      state.judged[i] = views_[i].Judge(views_[i].Expected(model_.PoseOf(frames_[i], values)));
    });
    for (const PoseView::Judgement& judged : state.judged) state.cost += judged.cost;
    for (const int entry : entries_) state.cost += 0.5 * std::pow(FromPrior(entry, values), 2);
    return state;
  }

  // In sigmas of the prior.
  double FromPrior(int entry, const ParameterValues& values) const {
    const auto& prior = catalog_[entry].prior;
    return prior ? (values[entry] - prior->coordinate) / prior->sigma : 0.0;
  }

  // What a small move of the sonar changes, frame by frame: pixels x kPoseSteps.
  std::vector<Eigen::MatrixXf> SlopesAt(const ParameterValues& values) const {
    const auto pixels = static_cast<Eigen::Index>(model_.pixel_count());
    std::vector<Eigen::MatrixXf> slopes(frames_.size(), Eigen::MatrixXf(pixels, kPoseSteps));
    tbb::parallel_for(std::size_t{0}, frames_.size() * kPoseSteps, [&](std::size_t task) {
      const std::size_t i = task / kPoseSteps;
      const auto k = static_cast<Eigen::Index>(task % kPoseSteps);
      const Pose pose = model_.PoseOf(frames_[i], values);
      PoseStep move = PoseStep::Zero();
      move(k) = PoseDifference(model_.sonar().axes, static_cast<int>(k));
      slopes[i].col(k) =
          (views_[i].Expected(MovePose(pose, move)) - views_[i].Expected(MovePose(pose, -move))) /
          static_cast<float>(2.0 * move(k));
    });
    return slopes;
  }

  // d move of the sonar / d value of each entry.
  Eigen::MatrixXd MovesOfEntries(int frame, const ParameterValues& values) const {
    constexpr double kDifference = 1e-5;
    const Pose pose = model_.PoseOf(frame, values);
    Eigen::MatrixXd moves(kPoseSteps, static_cast<Eigen::Index>(entries_.size()));
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      ParameterValues at = values;
      at[entries_[k]] += kDifference;
      moves.col(static_cast<Eigen::Index>(k)) = StepBetween(pose, model_.PoseOf(frame, at)) / kDifference;
    }
    return moves;
  }

  Normal NormalAt(const State& state, const std::vector<Eigen::MatrixXf>& slopes) const {
    const auto count = static_cast<Eigen::Index>(entries_.size());
    Normal normal{Eigen::MatrixXd::Zero(count, count), Eigen::VectorXd::Zero(count)};
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const PoseView::Judgement& judged = state.judged[i];
      const Eigen::MatrixXd slope = slopes[i].cast<double>();
      const Eigen::MatrixXd moves = MovesOfEntries(frames_[i], state.values);
      normal.information +=
          moves.transpose() * (slope.transpose() * judged.information.asDiagonal() * slope) * moves;
      normal.score += moves.transpose() * (slope.transpose() * judged.score);
    }
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto& prior = catalog_[entries_[k]].prior;
      if (!prior) continue;
      normal.information(k, k) += 1.0 / (prior->sigma * prior->sigma);
      normal.score(k) -= FromPrior(entries_[k], state.values) / prior->sigma;
    }
    return normal;
  }

  // Moves to a lower cost; returns by how much it fell, 0 where no step made it.
  double Step(const std::vector<Eigen::MatrixXf>& slopes, double& damping, State& state) const {
    const Normal normal = NormalAt(state, slopes);
    for (int i = 0; i < kTries; ++i, damping *= 10.0) {
      Eigen::MatrixXd damped = normal.information;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd step = damped.ldlt().solve(normal.score);
      ParameterValues values = state.values;
      for (std::size_t k = 0; k < entries_.size(); ++k)
        Set(entries_[k], values[entries_[k]] + step(static_cast<Eigen::Index>(k)), values);
      State trial = At(values);
      if (!(trial.cost < state.cost)) continue;
      const double fall = state.cost - trial.cost;
      state = std::move(trial);
      damping = std::max(0.2 * damping, 1e-6);
      return fall;
    }
    return 0.0;
  }

  // Other valleys lie along the direction that the frames tell least, as when a sonar steps aside and turns:
  // jumps along it, each followed by a step down. Returns by how much the cost fell.
  double TryAlongRidge(const std::vector<Eigen::MatrixXf>& slopes, State& state) const {
    const double cost_initial = state.cost;
    Eigen::VectorXd sigma = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(entries_.size()));
    for (Eigen::Index k = 0; k < sigma.size(); ++k) {
      if (const auto& prior = catalog_[entries_[k]].prior; prior) sigma(k) = prior->sigma;
    }
    const Eigen::MatrixXd in_sigmas =
        sigma.asDiagonal() * NormalAt(state, slopes).information * sigma.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(in_sigmas);
    const Eigen::VectorXd ridge = sigma.cwiseProduct(eigen.eigenvectors().col(0));
    const ParameterValues from = state.values;
    for (const double jump : {-0.6, -0.3, -0.15, 0.15, 0.3, 0.6}) {
      ParameterValues values = from;
      for (std::size_t k = 0; k < entries_.size(); ++k)
        Set(entries_[k], from[entries_[k]] + jump * ridge(static_cast<Eigen::Index>(k)), values);
      State trial = At(values);
      double damping = kFirstDamping;
      Step(slopes, damping, trial);
      if (trial.cost < state.cost) state = std::move(trial);
    }
    return cost_initial - state.cost;
  }

  // Of the entries, the one of this index where the problem is one whole pose; -1 otherwise.
  int EntryOf(int index) const {
    if (entries_.size() != kPoseSteps) return -1;
    for (const int entry : entries_) {
      if (catalog_[entry].index == index) return entry;
    }
    return -1;
  }

  // The values with the one whole pose of the problem moved.
  ParameterValues Moved(const ParameterValues& values, const PoseStep& move) const {
    PoseStep named;
    for (const int entry : entries_) named(catalog_[entry].index) = values[entry];
    named = NamedValues(MovePose(PoseFromNamedValues(named), move));
    ParameterValues moved = values;
    for (const int entry : entries_) Set(entry, named(catalog_[entry].index), moved);
    return moved;
  }

  // Within the entry's bounds.
  void Set(int entry, double value, ParameterValues& values) const {
    values[entry] = std::clamp(value, catalog_[entry].lower, catalog_[entry].upper);
  }

  const AcousticFrameModel& model_;
  const std::vector<CatalogEntry>& catalog_;
  std::vector<int> entries_;
  std::vector<int> frames_;
  RayFan fan_;
  std::vector<PoseView> views_;
};

}  // namespace

std::vector<PoseStage> PoseStages(const FrameModel::Grain& grain) {
  constexpr double kFar = 4.0;
  constexpr double kFarBeams = 2.0;
  constexpr double kNearBeams = 0.5;
  return {{.smoothing = {kFar * grain.bins, kFarBeams * grain.beams}, .slopes = 2, .thin = 2, .sweep = true},
          {.smoothing = {grain.bins, kNearBeams * grain.beams}, .slopes = 2, .along_ridge = true},
          {.smoothing = {}, .slopes = 3, .along_ridge = true}};
}

std::vector<int> FreePoseEntries(const std::vector<CatalogEntry>& catalog, const std::vector<bool>& free) {
  std::vector<int> entries;
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (free[i] && catalog[i].group == ParameterGroup::kPose) entries.push_back(static_cast<int>(i));
  }
  return entries;
}

double RefinePoses(const AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
                   const std::vector<int>& entries, const PoseStage& stage, ParameterValues& values,
                   const std::function<void(const std::string&)>& progress) {
  double falls = 0.0;
  std::set<int> moved;
  for (const int entry : entries) moved.insert(catalog[entry].frame);
  const double step_m = stage.smoothing.bins * model.sonar().axes.range_bin_m();
  const double step_deg = stage.smoothing.beams * DegFromRad(model.sonar().axes.beam_spacing_rad());
  const auto refine = [&](std::vector<int> frames, std::vector<int> of, const std::string& name) {
    PoseProblem problem(model, catalog, stage, std::move(frames), std::move(of), values);
    if (stage.sweep) problem.Sweep(step_m, step_deg, values);
    const double fall = problem.Solve(stage.slopes, stage.along_ridge, values);
    falls += fall;
    if (progress) progress(fmt::format("{}: cost down by {:.4g}", name, fall));
  };
  if (moved.count(kMountFrame) != 0) {
    std::vector<int> all;
    for (int frame = 0; frame < model.frame_count(); ++frame) all.push_back(frame);
    refine(all, entries, moved.size() > 1 ? "mount and poses" : "mount");
    return falls;
  }
  for (const int frame : moved) {
    std::vector<int> of;
    std::copy_if(entries.begin(), entries.end(), std::back_inserter(of),
                 [&](int entry) { return catalog[entry].frame == frame; });
    refine({frame}, of, fmt::format("pose of frame {}", model.frame_index(frame)));
  }
  return falls;
}

}  // namespace sonarcal
