#include "calib/poses/pose_ambiguity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "calib/poses/pose_problem.h"

namespace sonarcal::calib {
namespace {

constexpr double kApart = 4.0;          // min distance of two different poses, sigmas
constexpr int kStepsDown = 3;           // number of steps downhill in the search for another valley
constexpr double kMaxStartNats = 60.0;  // nats; a start with more is abandoned
constexpr int kDecimation = 2;          // of the rays of the search

std::string StepText(const PoseStep& step) {
  return fmt::format("{:.0f} mm right, {:.0f} ahead, {:.0f} up; roll {:+.2f}, pitch {:+.2f}, yaw {:+.2f} deg",
                     1e3 * step(0), 1e3 * step(1), 1e3 * step(2), step(3), step(4), step(5));
}

std::string Sentence(int index, const char* kind, const PoseStep& step, double worse_by) {
  return worse_by < 0.0
             ? fmt::format("pose.{}: {} ({}) fits the frame better than the reported pose, by {:.1f} nats",
                           index, kind, StepText(step), -worse_by)
             : fmt::format("pose.{}: {} ({}) fits the frame nearly as well, {:.1f} nats worse", index, kind,
                           StepText(step), worse_by);
}

// Follows a start downhill. Returns its end if that is another pose and fits equally well. `kind` names the
// start.
std::optional<OtherPose> Follow(const PoseProblem& problem, const AcousticFrameModel& model,
                                const std::vector<CatalogEntry>& catalog, int frame,
                                const PoseProblem::State& fitted, const Eigen::MatrixXd& information,
                                const std::vector<int>& entries, const ParameterValues& start,
                                const char* kind) {
  PoseProblem::State state = problem.At(start);
  if (state.cost > fitted.cost + kMaxStartNats) return std::nullopt;
  const PoseProblem::Slopes slopes = problem.SlopesAt(state.values);
  double damping = 1e-3;
  for (int i = 0; i < kStepsDown; ++i) problem.Step(slopes, damping, state);
  if (state.cost > fitted.cost + kMaxWorseNats) return std::nullopt;
  Eigen::VectorXd moved(static_cast<Eigen::Index>(entries.size()));
  for (std::size_t k = 0; k < entries.size(); ++k)
    moved(static_cast<Eigen::Index>(k)) = state.values[entries[k]] - fitted.values[entries[k]];
  if (moved.dot(information * moved) < kApart * kApart) return std::nullopt;
  double worse_by = state.cost - fitted.cost;
  if (worse_by < 0.0) {  // by all rays
    const PoseProblem exact(model, catalog, {}, 1, {frame}, entries, fitted.values);
    worse_by = exact.At(state.values).cost - exact.At(fitted.values).cost;
    if (worse_by > kMaxWorseNats) return std::nullopt;
  }
  const PoseStep step = StepBetween(model.PoseOf(frame, fitted.values), model.PoseOf(frame, state.values));
  OtherPose other{.frame = frame,
                  .entries = {},
                  .worse_by = worse_by,
                  .sentence = Sentence(model.frame_index(frame), kind, step, worse_by)};
  for (const int entry : entries) other.entries.emplace_back(entry, state.values[entry]);
  return other;
}

// Min and max height of the first intersections of a pose's rays, m; nullopt if they meet nothing.
std::optional<std::pair<double, double>> HeightsSeen(const AcousticFrameModel& model,
                                                     const ParameterValues& values, const Pose& pose) {
  constexpr int kFew = 8;
  const auto [simulator, fan] = model.RaysAt(values, kFew);
  const sim::EchoList echoes =
      sim::Trace(simulator->caster(), fan, pose, simulator->sonar().axes, simulator->options().trace);
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
    const auto ray = static_cast<int>(echoes.ray[echo]);
    const Eigen::Vector3d direction = fan.Direction(ray / fan.cols(), ray % fan.cols()).cast<double>();
    const double height_m = (pose * (direction * static_cast<double>(echoes.range_m[echo]))).z();
    lowest = std::min(lowest, height_m);
    highest = std::max(highest, height_m);
  }
  if (echoes.size() == 0) return std::nullopt;
  return std::pair{lowest, highest};
}

// Returns the values with the pose of a frame replaced; nullopt if its prior excludes that.
std::optional<ParameterValues> WithPose(const Pose& pose, const std::vector<CatalogEntry>& catalog,
                                        const std::vector<int>& entries, const ParameterValues& values) {
  PoseStep before;
  for (const int entry : entries) before(catalog[entry].index) = values[entry];
  const PoseStep named = NearestTurns(NamedValues(pose), before);
  ParameterValues with = values;
  double from_prior = 0.0;
  double was = 0.0;
  for (const int entry : entries) {
    const CatalogEntry& of = catalog[entry];
    with[entry] = named(of.index);
    if (with[entry] < of.lower || with[entry] > of.upper) return std::nullopt;
    if (!of.prior) continue;
    from_prior += 0.5 * std::pow((with[entry] - of.prior->coordinate) / of.prior->sigma, 2);
    was += 0.5 * std::pow((values[entry] - of.prior->coordinate) / of.prior->sigma, 2);
  }
  if (from_prior > was + kMaxStartNats) return std::nullopt;
  return with;
}

std::vector<OtherPose> OtherPosesOf(const AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
                                    int frame, const std::vector<int>& entries,
                                    const ParameterValues& values) {
  const PoseProblem problem(model, catalog, {}, kDecimation, {frame}, entries, values);
  const PoseProblem::State fitted = problem.At(values);
  const PoseProblem::Slopes slopes = problem.SlopesAt(values);
  const Eigen::MatrixXd information = problem.NormalAt(fitted, slopes).information;
  std::vector<OtherPose> others;
  const auto follow = [&](const ParameterValues& start, const char* kind) {
    if (auto other = Follow(problem, model, catalog, frame, fitted, information, entries, start, kind))
      others.push_back(std::move(*other));
  };
  const Eigen::VectorXd ridge = problem.Ridge(fitted, slopes);
  for (const double sigmas : {-1.5, -0.5, 0.5, 1.5})
    follow(problem.MovedEntries(values, sigmas * ridge), "another pose along the least determined direction");
  const Pose pose = model.PoseOf(frame, values);
  if (const auto heights = HeightsSeen(model, values, pose)) {
    // The entries hold the pose without the mount and the tilt.
    const Pose mirrored =
        ReflectedPose(pose, heights->first, heights->second) * model.MountOf(values).Inverse();
    if (const auto start = WithPose(mirrored, catalog, entries, values)) follow(*start, "its mirror image");
  }
  return others;
}

}  // namespace

Pose ReflectedPose(const Pose& world_from_sonar, double lowest_m, double highest_m) {
  PoseStep named = NamedValues(world_from_sonar);
  named(2) = lowest_m + highest_m - named(2);
  named(3) = -named(3);
  named(4) = -named(4);
  return PoseFromNamedValues(named);
}

std::vector<OtherPose> OtherPoses(const AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
                                  const std::vector<int>& entries, const ParameterValues& values) {
  std::map<int, std::vector<int>> by_frame;
  for (const int entry : entries) {
    if (catalog[entry].group == ParameterGroup::kPose) by_frame[catalog[entry].frame].push_back(entry);
  }
  std::vector<OtherPose> others;
  if (by_frame.contains(kMountFrame)) return others;
  for (const auto& [frame, of] : by_frame) {
    if (of.size() != kPoseSteps) continue;
    for (OtherPose& other : OtherPosesOf(model, catalog, frame, of, values))
      others.push_back(std::move(other));
  }
  return others;
}

std::set<int> TakeBetterPoses(const std::vector<OtherPose>& others, double by_nats, ParameterValues& values) {
  std::map<int, const OtherPose*> best;
  for (const OtherPose& other : others) {
    if (!(other.worse_by < -by_nats)) continue;
    const OtherPose*& of_frame = best[other.frame];
    if (of_frame == nullptr || other.worse_by < of_frame->worse_by) of_frame = &other;
  }
  std::set<int> moved;
  for (const auto& [frame, other] : best) {
    moved.insert(frame);
    for (const auto& [entry, value] : other->entries) values[entry] = value;
  }
  return moved;
}

}  // namespace sonarcal::calib
