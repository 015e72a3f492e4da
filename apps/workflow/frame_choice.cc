#include "apps/workflow/frame_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "apps/workflow/compare.h"
#include "calib/selection/frame_choice.h"
#include "calib/selection/frame_information.h"
#include "core/math/pose_groups.h"
#include "sim/rays/acoustic_fan.h"
#include "sim/simulator.h"

namespace sonarcal::workflow {
namespace {

// Number of poses that are traced. More would take longer than they gain.
constexpr int kMaxCandidates = 300;

// Frames that look at nothing determine less than this, nats.
constexpr double kNothingNats = 1e-6;

// Frames that may be fitted, with the poses of one group each.
struct Candidates {
  std::vector<std::vector<int>> frames;  // per pose
  std::vector<Pose> poses;
  std::vector<int> counts;  // frames per pose
};

Candidates CandidatesOf(const std::vector<Pose>& poses, const std::vector<char>& may_be_fitted) {
  std::vector<std::vector<int>> groups = GroupByPose(poses);
  for (std::vector<int>& group : groups)
    std::erase_if(group, [&](int frame) { return may_be_fitted[frame] == 0; });
  std::erase_if(groups, [](const std::vector<int>& group) { return group.empty(); });
  std::vector<int> all(groups.size());
  std::iota(all.begin(), all.end(), 0);
  Candidates candidates;
  for (const int group : EvenlySpread(all, kMaxCandidates)) {
    candidates.frames.push_back(groups[group]);
    candidates.poses.push_back(poses[groups[group].front()]);
    candidates.counts.push_back(static_cast<int>(groups[group].size()));
  }
  return candidates;
}

sim::SimulationOptions FewRays(const FrameChoiceScene& known) {
  sim::SimulationOptions rays;
  rays.fan = sim::AcousticFanOptions(known.sonar, known.parameters);
  rays.absorption = known.absorption;
  rays.water = known.water;
  return rays;
}

struct MaxFrames {
  int fitted = 0;
  int held_out = 0;
  bool by_size = false;  // the size of the frames limits `fitted`
};

MaxFrames MaxFramesOf(const FrameChoiceOptions& options, const PolarAxes& axes, int free_count) {
  const double pixels = std::max(1.0, static_cast<double>(axes.range_bins) * axes.beam_count());
  const int together = static_cast<int>(std::min(1e6, kMaxFittedPixels / pixels));
  const int by_size = std::max(2, options.fits_held_out ? 2 * together / 3 : together);
  MaxFrames max{.fitted = std::min(options.limits.max_frames, by_size),
                .held_out = options.limits.max_held_out,
                .by_size = by_size < options.limits.max_frames};
  if (options.fits_held_out) max.held_out = std::min(max.held_out, std::max(1, together / 3));
  // A third stays for the evaluation.
  const int by_count = options.held_out ? free_count : std::max(1, 2 * free_count / 3);
  max.by_size = max.by_size && max.fitted <= by_count;
  max.fitted = std::min(max.fitted, by_count);
  return max;
}

std::string ReasonOf(const calib::InformationChoice& choice, int poses, const MaxFrames& max) {
  const std::string why_no_more = choice.ended_by_gain
                                      ? std::string()
                                      : fmt::format("; max {} are {}", max.fitted,
                                                    max.by_size ? "fitted of frames of this size" : "fitted");
  return fmt::format(
      "these are expected to determine curves and geometry best, of {} poses traced{}; the best other frame "
      "would lower the standard errors by {:.1f} %",
      poses, why_no_more, 100.0 * choice.next_gain);
}

}  // namespace

bool NeedsFrameChoice(int frame_count, const FrameChoiceOptions& options) {
  return frame_count > options.limits.max_frames + options.limits.max_held_out;
}

ChosenFrames ChooseFrames(const FrameChoiceScene& known, const std::vector<data_io::TimedPose>& timed_poses,
                          const FrameChoiceOptions& options) {
  const std::vector<Pose> poses = data_io::PosesAlone(timed_poses);
  std::vector<char> may_be_fitted(poses.size(), 1);
  if (options.held_out) {
    for (const int frame : *options.held_out) may_be_fitted[frame] = 0;
  }
  const auto free_count = static_cast<int>(std::ranges::count(may_be_fitted, 1));
  const MaxFrames max = MaxFramesOf(options, known.sonar.axes, free_count);
  const Candidates candidates = CandidatesOf(poses, may_be_fitted);
  const sim::Simulator simulator(known.scene, known.sonar, FewRays(known));
  const calib::FrameInformation information(
      simulator, known.parameters, candidates.poses,
      {.geometry = options.geometry, .poses = options.poses, .pose_prior = options.pose_prior});
  const calib::InformationChoice choice =
      calib::ChooseByInformation(candidates.counts, information, {.max_frames = max.fitted});

  ChosenFrames chosen;
  if (choice.gains.empty() || choice.gains.front() < kNothingNats) {
    std::vector<int> free;
    for (int frame = 0; frame < static_cast<int>(poses.size()); ++frame) {
      if (may_be_fitted[frame] != 0) free.push_back(frame);
    }
    chosen.used = EvenlySpread(free, max.fitted);
    chosen.reason = "they are evenly spread, because the start parameters expect no echo from any pose";
  } else {
    std::vector<int> next(candidates.poses.size(), 0);
    for (const int pose : choice.poses) chosen.used.push_back(candidates.frames[pose][next[pose]++]);
    std::ranges::sort(chosen.used);
    chosen.reason = ReasonOf(choice, static_cast<int>(candidates.poses.size()), max);
  }
  if (options.held_out) {
    chosen.held_out = *options.held_out;
  } else {
    const double reach_m = 0.5 * (known.sonar.axes.range_min_m + known.sonar.axes.range_max_m);
    chosen.held_out = EvenlySpread(calib::FramesAwayFrom(chosen.used, poses, reach_m), max.held_out);
  }
  chosen.choice = fmt::format("{} of {} frames are fitted, {} held out", chosen.used.size(), poses.size(),
                              chosen.held_out.size());
  return chosen;
}

}  // namespace sonarcal::workflow
