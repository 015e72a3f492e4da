#include "calib/poses/pose_refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "calib/poses/pose_problem.h"
#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

constexpr int kStepsOfSlopes = 3;
constexpr double kFirstRefinementDamping = 1e-3;
// Fall of the cost that ends a stage: 1/100 of the effect of noise on one parameter.
constexpr double kSettled = 0.005;

// Tries headings and distances within twice the prior sigma, if the problem is one whole pose.
void Sweep(const PoseProblem& problem, double step_m, double step_deg, ParameterValues& values) {
  PoseProblem::State best = problem.At(values);
  for (const int component : {5, 1}) {  // heading, distance
    const int entry = problem.EntryOf(component);
    if (entry < 0 || !problem.entry(entry).prior) continue;
    const double step = component == 5 ? step_deg : step_m;
    const int reach = static_cast<int>(std::min(4.0, 2.0 * problem.entry(entry).prior->sigma / step));
    const ParameterValues from = best.values;
    for (int k = -reach; k <= reach; ++k) {
      if (k == 0) continue;
      PoseStep move = PoseStep::Zero();
      move(component) = k * step;
      PoseProblem::State trial = problem.At(problem.MovedSonar(from, move));
      if (trial.cost < best.cost) best = std::move(trial);
    }
  }
  values = best.values;
}

// Other valleys lie along the direction that the frames determine least, for example if the sonar steps aside
// and turns. Jumps along it, each time with a step downhill. Returns the fall of the cost.
double TryAlongRidge(const PoseProblem& problem, const PoseProblem::Slopes& slopes,
                     PoseProblem::State& state) {
  const double cost_initial = state.cost;
  const Eigen::VectorXd ridge = problem.Ridge(state, slopes);
  const ParameterValues from = state.values;
  for (const double jump : {-0.6, -0.3, -0.15, 0.15, 0.3, 0.6}) {
    PoseProblem::State trial = problem.At(problem.MovedEntries(from, jump * ridge));
    double damping = kFirstRefinementDamping;
    problem.Step(slopes, damping, trial);
    if (trial.cost < state.cost) state = std::move(trial);
  }
  return cost_initial - state.cost;
}

// Returns the fall of the cost.
double Solve(const PoseProblem& problem, int slope_rounds, bool along_ridge, ParameterValues& values) {
  PoseProblem::State state = problem.At(values);
  const double cost_initial = state.cost;
  double damping = kFirstRefinementDamping;
  for (int round = 0; round < slope_rounds; ++round) {
    const PoseProblem::Slopes slopes = problem.SlopesAt(state.values);
    double fall = along_ridge && round == 0 ? TryAlongRidge(problem, slopes, state) : 0.0;
    for (int step = 0; step < kStepsOfSlopes; ++step) {
      const double of_step = problem.Step(slopes, damping, state);
      fall += of_step;
      if (of_step < kSettled) break;
    }
    if (fall < kSettled) break;
  }
  values = state.values;
  return cost_initial - state.cost;
}

}  // namespace

std::vector<PoseStage> PoseStages(const FrameModel::SpeckleCell& speckle_cell) {
  constexpr double kFar = 4.0;
  constexpr double kFarBeams = 2.0;
  constexpr double kNearBeams = 0.5;
  return {{.smoothing = {kFar * speckle_cell.bins, kFarBeams * speckle_cell.beams},
           .slopes = 1,
           .decimation = 4,
           .sweep = true},
          {.smoothing = {speckle_cell.bins, kNearBeams * speckle_cell.beams},
           .slopes = 1,
           .decimation = 2,
           .along_ridge = true},
          {.smoothing = {}, .slopes = 2}};
}

std::vector<int> FreePlacements(const std::vector<CatalogEntry>& catalog, const std::vector<bool>& free) {
  std::vector<int> entries;
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (free[i] && IsPlacement(catalog[i])) entries.push_back(static_cast<int>(i));
  }
  return entries;
}

void RefinePoses(const AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
                 const std::vector<int>& entries, const PoseStage& stage, ParameterValues& values,
                 const std::function<void(const std::string&)>& progress) {
  std::set<int> moved;
  bool common = false;
  for (const int entry : entries) {
    common = common || IsSharedPlacement(catalog[entry]);
    if (!IsSharedPlacement(catalog[entry])) moved.insert(catalog[entry].frame);
  }
  const double step_m = stage.smoothing.bins * model.sonar().axes.range_bin_m();
  const double step_deg = stage.smoothing.beams * DegFromRad(model.sonar().axes.beam_spacing_rad());
  const auto refine = [&](std::vector<int> frames, std::vector<int> of, const std::string& name) {
    const PoseProblem problem(model, catalog, stage.smoothing, stage.decimation, std::move(frames),
                              std::move(of), values);
    if (stage.sweep) Sweep(problem, step_m, step_deg, values);
    const double fall = Solve(problem, stage.slopes, stage.along_ridge, values);
    if (progress) progress(fmt::format("{}: cost down by {:.4g}", name, fall));
  };
  if (common) {
    std::vector<int> all;
    for (int frame = 0; frame < model.frame_count(); ++frame) all.push_back(frame);
    refine(all, entries, moved.empty() ? "placement common to all frames" : "common placement and poses");
    return;
  }
  for (const int frame : moved) {
    std::vector<int> of;
    std::copy_if(entries.begin(), entries.end(), std::back_inserter(of),
                 [&](int entry) { return catalog[entry].frame == frame; });
    refine({frame}, of, fmt::format("pose of frame {}", model.frame_index(frame)));
  }
}

}  // namespace sonarcal::calib
