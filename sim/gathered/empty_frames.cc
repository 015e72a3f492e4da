#include "sim/gathered/empty_frames.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "core/types/error.h"
#include "sim/rays/trace.h"

namespace sonarcal::sim {
namespace {

// Likely reason why no ray of a pose hits the scene, from the scene's bounding box.
std::string LikelyReason(const PolarAxes& axes, const Eigen::AlignedBox3f& box,
                         const Pose& world_from_sonar) {
  const Eigen::Vector3f sonar_m = world_from_sonar.position_m.cast<float>();
  const double away_m = box.exteriorDistance(sonar_m);
  if (away_m > axes.range_max_m) {
    return fmt::format(
        "the scene begins {:.4g} m away from the sonar, beyond the range window; check the unit of the scene "
        "and the positions",
        away_m);
  }
  const double diagonal_m = box.diagonal().norm();
  if (diagonal_m < axes.range_bin_m()) {
    return fmt::format("the scene is only {:.4g} m large; check its unit", diagonal_m);
  }
  const Eigen::Vector3d ahead = world_from_sonar.rotation * Eigen::Vector3d::UnitY();
  const Eigen::Vector3d to_scene = box.center().cast<double>() - world_from_sonar.position_m;
  if (away_m > 0.0 && ahead.dot(to_scene.normalized()) < 0.5) {
    return fmt::format(
        "the sonar looks along ({:.2f}, {:.2f}, {:.2f}) and the scene lies elsewhere; check the axes of the "
        "poses (Y of the sonar is forward, Z up) and the upward axis of the scene",
        ahead.x(), ahead.y(), ahead.z());
  }
  constexpr double kManyWindows = 100.0;
  if (diagonal_m > kManyWindows * axes.range_max_m) {
    return fmt::format("the scene is {:.4g} m large; check its unit", diagonal_m);
  }
  return "check the positions, the direction of view and the range window";
}

std::string WhyEmpty(const Simulator& simulator, const std::vector<Pose>& world_from_sonar, int frame) {
  const PolarAxes& axes = simulator.sonar().axes;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex_m : simulator.caster().scene().vertices_m) box.extend(vertex_m);
  const Pose& pose = world_from_sonar[static_cast<std::size_t>(frame)];
  const Eigen::Vector3d& at = pose.position_m;
  return fmt::format(
      "no ray hits the scene within {:g} .. {:g} m. In frame {} the sonar is at ({:.4g}, {:.4g}, {:.4g}) m, "
      "the scene spans ({:.4g}, {:.4g}, {:.4g}) .. ({:.4g}, {:.4g}, {:.4g}) m: {}",
      axes.range_min_m, axes.range_max_m, frame, at.x(), at.y(), at.z(), box.min().x(), box.min().y(),
      box.min().z(), box.max().x(), box.max().y(), box.max().z(), LikelyReason(axes, box, pose));
}

std::string Listed(const std::vector<int>& indices) {
  constexpr std::size_t kMaxListed = 8;
  std::vector<int> first(indices.begin(), indices.begin() + std::min(indices.size(), kMaxListed));
  return fmt::format("{}{}", fmt::join(first, ", "), indices.size() > kMaxListed ? ", ..." : "");
}

}  // namespace

std::vector<int> PosesThatSeeNothing(const Simulator& simulator, const std::vector<Pose>& world_from_sonar,
                                     const std::function<void(int done)>& progress) {
  const SonarModel& sonar = simulator.sonar();
  const RayFan few(sonar, {.sampling = Sampling::kBeams,
                           .cols = sonar.axes.beam_count(),
                           .rows = std::min(16, simulator.fan().rows()),
                           .elevation_span_deg = simulator.options().fan.elevation_span_deg});
  std::vector<int> empty;
  for (std::size_t i = 0; i < world_from_sonar.size(); ++i) {
    if (Trace(simulator.caster(), few, world_from_sonar[i], sonar.axes).size() == 0 &&
        simulator.TraceEchoes(world_from_sonar[i]).size() == 0) {
      empty.push_back(static_cast<int>(i));
    }
    if (progress) progress(static_cast<int>(i) + 1);
  }
  return empty;
}

std::string CheckSceneIsSeen(const Simulator& simulator, const std::vector<Pose>& world_from_sonar,
                             const std::vector<int>& frames, const std::vector<int>& empty) {
  if (empty.empty()) return {};
  const std::string why = WhyEmpty(simulator, world_from_sonar, empty.front());
  if (empty.size() == frames.size()) throw DataError("the recording's poses do not show the scene: {}", why);
  return fmt::format("warning: {} of {} frames used do not show the scene ({}): {}", empty.size(),
                     frames.size(), Listed(empty), why);
}

std::string CheckSceneIsSeen(const Simulator& simulator, const std::vector<Pose>& world_from_sonar,
                             const std::vector<int>& frames) {
  std::vector<Pose> poses;
  for (const int frame : frames) poses.push_back(world_from_sonar[static_cast<std::size_t>(frame)]);
  std::vector<int> empty;
  for (const int position : PosesThatSeeNothing(simulator, poses))
    empty.push_back(frames[static_cast<std::size_t>(position)]);
  return CheckSceneIsSeen(simulator, world_from_sonar, frames, empty);
}

std::string EmptyFramesWarning(const Simulator& simulator, const std::vector<Pose>& world_from_sonar,
                               const std::vector<int>& empty) {
  if (empty.empty()) return {};
  return fmt::format("warning: {}: {}",
                     empty.size() == world_from_sonar.size()
                         ? std::string("every frame is empty")
                         : fmt::format("{} of {} frames are empty ({})", empty.size(),
                                       world_from_sonar.size(), Listed(empty)),
                     WhyEmpty(simulator, world_from_sonar, empty.front()));
}

}  // namespace sonarcal::sim
