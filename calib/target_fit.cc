#include "calib/target_fit.h"

#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

std::vector<std::string> ModelParameters(const Scene& target) {
  std::vector<std::string> free = {"receiver.noise_db", "beam.azimuth_width_deg", "beam.elevation_width_deg",
                                   "pulse.length_m"};
  for (const std::string& material : target.material_names) {
    for (const char* of : {"C", "D", "E", "F_deg"}) free.push_back("material." + material + ".gsab." + of);
  }
  return free;
}

FitConfig ConfigFor(const Scene& target, const SonarModel& sonar, const Pose& world_from_sonar,
                    const TargetFitOptions& options) {
  FitConfig config;
  std::vector<std::string> free;
  if (options.free_model) free = ModelParameters(target);
  const double bin_m = sonar.axes.range_bin_m();
  config.bounds["beam.azimuth_width_deg"] = {options.beam_width_min_deg, options.beam_width_max_deg};
  config.bounds["beam.elevation_width_deg"] = {options.elevation_width_min_deg,
                                               options.elevation_width_max_deg};
  config.bounds["pulse.length_m"] = {bin_m, options.pulse_max_bins * bin_m};
  config.held_out.emplace();
  if (options.free_pose) free.emplace_back("pose.0.*");
  config.free = free;
  if (!options.free_pose) return config;
  constexpr const char* kShifts[] = {"x_m", "y_m", "z_m"};
  for (int axis = 0; axis < 3; ++axis) {
    const double at = world_from_sonar.position_m(axis);
    config.bounds[std::string("pose.0.") + kShifts[axis]] = {at - options.pose_shift_m,
                                                             at + options.pose_shift_m};
  }
  for (const char* turn : {"roll_deg", "pitch_deg", "yaw_deg"}) {
    config.bounds[std::string("pose.0.") + turn] = {-options.pose_turn_deg, options.pose_turn_deg};
  }
  return config;
}

}  // namespace

Scene PlacedTarget(const Scene& target, const TargetPose& pose) {
  Scene placed = target;
  const Eigen::Quaternionf rotation = pose.SonarFromTarget().rotation.cast<float>();
  for (Eigen::Vector3f& vertex : placed.vertices_m) vertex = rotation * vertex;
  return placed;
}

Pose SonarOfPlaced(const TargetPose& pose) {
  return {Eigen::Quaterniond::Identity(), -pose.SonarFromTarget().position_m};
}

TargetFit FitTarget(const Scene& target, const SonarModel& sonar, const Water& water,
                    const PolarImage& recorded, const TargetPose& pose, const ParameterSet& initial,
                    const TargetFitOptions& options) {
  TargetFit result;
  result.placed = PlacedTarget(target, pose);
  result.simulation.water = water;
  result.simulation.noise = true;
  result.simulation.fan = {
      .sampling = sim::Sampling::kBeams,
      .cols = sonar.axes.beam_count() * options.cols_per_beam,
      .rows = static_cast<int>(std::ceil(options.elevation_span_deg / options.ray_height_deg)),
      .elevation_span_deg = options.elevation_span_deg,
      .azimuth_margin_deg = options.azimuth_margin_deg,
      .stagger = true,
      .stagger_rows = true};
  // Uses more rays for a free pose: only few rays hit the edges of a small target, and they determine its
  // pose.
  if (options.free_pose) {
    result.simulation.fan.cols *= 2;
    result.simulation.fan.rows *= 2;
  }
  const sim::Simulator simulator(result.placed, sonar, result.simulation);
  std::vector<AcousticFrame> frames = {{.index = 0,
                                        .world_from_sonar = SonarOfPlaced(pose),
                                        .recorded = RecordedPowers(recorded, initial.display)}};
  const std::span<const std::uint8_t> use = options.pixels.values();
  frames[0].use.assign(use.begin(), use.end());
  FitOptions fit = options.fit;
  fit.threads = options.threads;
  result.fit = FitAcousticModel(simulator, frames, initial,
                                ConfigFor(target, sonar, frames[0].world_from_sonar, options), fit);
  return result;
}

}  // namespace sonarcal::calib
