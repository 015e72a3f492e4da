// Pings of a frame, and the motion of the sonar between them.
//
// Some sonars receive the beams of a frame by several pings, one after the other. If the sonar moves, each
// beam has the pose of its ping. The pose of a ping is that of the frame after the time of the ping:
//
//   world_from_ping = world_from_sonar * frame_from_ping
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <optional>
#include <vector>

#include "core/types/image.h"
#include "core/types/pose.h"
#include "core/types/rotation.h"
#include "core/types/units.h"

namespace sonarcal {

// Pings that make a frame. Default: one ping.
struct PingPattern {
  std::vector<int> of_beam;  // ping of each beam, 0 is the first; empty: one ping receives all beams
  double period_s = 0.0;     // time between two pings; 0 = unknown
  double first_s = 0.0;      // time of ping 0, counted from the time of the frame

  int count() const { return of_beam.empty() ? 1 : 1 + *std::max_element(of_beam.begin(), of_beam.end()); }
  // True if a frame has several pings at known times.
  bool is_timed() const { return period_s > 0.0 && count() > 1; }
  double TimeOf(int ping) const { return first_s + ping * period_s; }

  bool operator==(const PingPattern&) const = default;
};

// Motion of a sonar during a frame, in its own axes at the time of the frame: along a straight line, and at a
// constant rate about an axis that is fixed in the sonar.
struct Motion {
  Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_rate_rad_per_s = Eigen::Vector3d::Zero();

  // Pose of the sonar this time after that of the frame, in the axes of the frame.
  Pose After(double time_s) const {
    return {Turned(Eigen::Quaterniond::Identity(), turn_rate_rad_per_s * time_s), velocity_m_per_s * time_s};
  }

  bool operator==(const Motion&) const = default;
};

// A faster motion is a mistake in the poses or their times.
inline constexpr double kMaxSpeedMPerS = 1000.0;
inline constexpr double kMaxTurnRateDegPerS = 36000.0;

inline bool IsPlausible(const Motion& motion) {
  return motion.velocity_m_per_s.cwiseAbs().maxCoeff() <= kMaxSpeedMPerS &&
         motion.turn_rate_rad_per_s.cwiseAbs().maxCoeff() <= RadFromDeg(kMaxTurnRateDegPerS);
}

// Constant motion that leads from one pose to another in `time_s`, in the axes of a third pose between them.
inline Motion MotionBetween(const Pose& first, const Pose& last, const Pose& axes, double time_s) {
  const Eigen::AngleAxisd turn(first.rotation.conjugate() * last.rotation);  // by at most half a turn
  return {.velocity_m_per_s = axes.rotation.conjugate() * (last.position_m - first.position_m) / time_s,
          .turn_rate_rad_per_s = turn.axis() * (turn.angle() / time_s)};
}

// Pose of one ping of a frame, and the beams that it receives.
struct PingPose {
  Pose frame_from_ping;
  std::vector<int> beams;  // ascending
};

// Returns the pings that receive a beam, in the order of time. Returns nothing if all beams share the pose of
// the frame: a frame of one ping, unknown times, no known motion, or less than a micrometre and a microradian
// of it.
inline std::vector<PingPose> PosesOfPings(const PingPattern& pings, const std::optional<Motion>& motion) {
  constexpr double kNegligible = 1e-6;
  if (!pings.is_timed() || !motion) return {};
  std::vector<PingPose> poses(pings.count());
  for (std::size_t beam = 0; beam < pings.of_beam.size(); ++beam)
    poses[pings.of_beam[beam]].beams.push_back(static_cast<int>(beam));
  for (std::size_t ping = 0; ping < poses.size(); ++ping)
    poses[ping].frame_from_ping = motion->After(pings.TimeOf(static_cast<int>(ping)));
  std::erase_if(poses, [](const PingPose& ping) { return ping.beams.empty(); });
  const bool moves = std::ranges::any_of(poses, [](const PingPose& ping) {
    return ping.frame_from_ping.position_m.norm() > kNegligible ||
           ping.frame_from_ping.rotation.vec().norm() > 0.5 * kNegligible;
  });
  if (!moves) poses.clear();
  return poses;
}

// Ping that receives all beams at the pose of the frame.
inline PingPose PingOfAllBeams(int beams) {
  PingPose ping{.frame_from_ping = {}, .beams = std::vector<int>(beams)};
  std::iota(ping.beams.begin(), ping.beams.end(), 0);
  return ping;
}

// Copy beams from one image to another of the same size.
template <typename T>
void CopyBeams(const std::vector<int>& beams, const Grid<T>& from, Grid<T>& to) {
  SONARCAL_CHECK(from.rows() == to.rows() && from.cols() == to.cols(), "images of {} x {} and {} x {}",
                 from.rows(), from.cols(), to.rows(), to.cols());
  for (int row = 0; row < from.rows(); ++row) {
    for (const int beam : beams) to(row, beam) = from(row, beam);
  }
}
inline void CopyBeams(const std::vector<int>& beams, const PolarImage& from, PolarImage& to) {
  CopyBeams(beams, from.value, to.value);
}

// Image whose beams have the poses of their pings. `render(pose)` makes the image of all beams at a pose: a
// grid or a PolarImage. `pings`: as PosesOfPings returns them; empty: one image at the pose of the frame.
template <typename Render>
auto RenderByPing(const Pose& world_from_sonar, const std::vector<PingPose>& pings, const Render& render) {
  if (pings.empty()) return render(world_from_sonar);
  auto image = render(world_from_sonar * pings.front().frame_from_ping);
  for (std::size_t ping = 1; ping < pings.size(); ++ping)
    CopyBeams(pings[ping].beams, render(world_from_sonar * pings[ping].frame_from_ping), image);
  return image;
}

}  // namespace sonarcal
