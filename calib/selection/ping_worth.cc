#include "calib/selection/ping_worth.h"

#include <fmt/format.h>

#include <algorithm>

#include "calib/problem_builder.h"
#include "core/types/units.h"

namespace sonarcal::calib {

std::optional<PingWorth> MeasurePingWorth(const sim::Simulator& simulator,
                                          const std::vector<GreyFrame>& frames, const PingPattern& pings,
                                          const ParameterSet& parameters, const FitOptions& options) {
  std::vector<GreyFrame> moved;
  std::ranges::copy_if(frames, std::back_inserter(moved),
                       [](const GreyFrame& frame) { return !frame.pings.empty(); });
  if (moved.empty()) return std::nullopt;
  PingWorth worth{.pings = pings.count(), .period_s = pings.period_s};
  for (const GreyFrame& frame : moved) {
    worth.frames.push_back(frame.index);
    const Pose way = frame.pings.front().frame_from_ping.Inverse() * frame.pings.back().frame_from_ping;
    worth.max_turn_deg = std::max(worth.max_turn_deg,
                                  DegFromRad(way.rotation.angularDistance(Eigen::Quaterniond::Identity())));
    worth.max_distance_m = std::max(worth.max_distance_m, way.position_m.norm());
  }
  const std::vector<AcousticFrame> by_ping = FramesFor(moved, parameters.display);
  std::vector<AcousticFrame> with_one_pose = by_ping;
  for (AcousticFrame& frame : with_one_pose) frame.pings.clear();
  const AcousticFrameModel with(simulator, by_ping, parameters);
  const AcousticFrameModel without(simulator, with_one_pose, parameters);
  const BlockPixels block = BlockSize(with, options);
  const auto likelihood = [&](const AcousticFrameModel& model) {
    BlockedLikelihood of = GreyLikelihood(moved, MeanPowers(model), parameters, block.bins, block.beams);
    of.variance_factor = block.variance_factor;
    return of;
  };
  const LikelihoodDifference gain = Difference(likelihood(with), likelihood(without));
  worth.gain_nats_per_pixel = gain.mean;
  worth.gain_sigma = gain.sigma;
  return worth;
}

std::string PingWorthText(const PingWorth& worth) {
  return fmt::format(
      "Each frame has {} pings, {:.4g} ms apart. From the first to the last, the sonar turns by up to {:.2g} "
      "degrees and moves by up to {:.2g} mm. {} On {} {} frame{}, the poses of the pings change the "
      "log-likelihood by {:+.4f} +- {:.4f} nats per pixel, with the same fitted values.",
      worth.pings, worth.period_s * 1e3, worth.max_turn_deg, worth.max_distance_m * 1e3,
      worth.used ? "The fit gives each beam the pose of its ping."
                 : "The fit ignores this: all beams have the pose of the frame.",
      worth.frames.size(), worth.held_out ? "held-out" : "fitted", worth.frames.size() == 1 ? "" : "s",
      worth.gain_nats_per_pixel, worth.gain_sigma);
}

}  // namespace sonarcal::calib
