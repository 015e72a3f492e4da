#include "tests/support/sphere_recording.h"

#include <algorithm>
#include <cmath>

#include "core/types/units.h"
#include "sim/coherent/coherent_image.h"
#include "sim/physics/display.h"
#include "tests/sim/meshes.h"

namespace sonarcal::testing {
namespace {

Eigen::Vector3d Direction(const SpherePlace& place) {
  return {std::cos(place.elevation_rad) * std::sin(place.azimuth_rad),
          std::cos(place.elevation_rad) * std::cos(place.azimuth_rad), std::sin(place.elevation_rad)};
}

// Pose from which the origin of the world appears at `place`.
Pose PoseThatSeesOriginAt(const SpherePlace& place) {
  const Eigen::Quaterniond rotation =
      RotationFromYawPitchRoll(place.azimuth_rad, -place.elevation_rad, place.roll_rad);
  return {rotation, rotation * (-place.range_m * Direction(place))};
}

PolarImage Shown(PolarImage image, const DisplayParameters<double>& display) {
  constexpr double kFullScale = 255.0;
  for (float& value : image.value.values()) {
    const double shown = std::clamp(sim::DisplayValue(display, double{value}), 0.0, 1.0);
    value = static_cast<float>(std::round(kFullScale * shown));
  }
  image.scale = ImageScale();
  image.scale.full_scale = kFullScale;
  image.scale.db_min = display.db_min;
  image.scale.db_max = display.db_max;
  return image;
}

}  // namespace

MemoryRecording SphereRecording(const SphereRecordingOptions& options) {
  // Open water: the only surface lies behind the sonar, out of sight.
  Scene scene;
  AddQuad(scene, {-1, -500, -1}, {2, 0, 0}, {0, 0, 2}, "default");
  const sim::RayCaster caster(scene);
  const sim::RayFan fan(options.sonar, {.sampling = sim::Sampling::kBeams,
                                        .cols = options.sonar.axes.beam_count(),
                                        .rows = 2,
                                        .elevation_span_deg = 10.0});
  RecordingInfo info;
  info.source = "SYNTHETIC sphere";
  info.format = "test";
  info.sonar = options.sonar;
  info.synthetic = true;
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < options.places.size(); ++i) {
    const Pose pose = PoseThatSeesOriginAt(options.places[i]);
    sim::CoherentGeometry geometry{caster, fan, options.sonar, options.absorption_db_per_m};
    const double change_db = options.level_change_db.empty() ? 0.0 : options.level_change_db[i];
    geometry.point_targets = {{Eigen::Vector3d::Zero(), options.cross_section_m2 * PowerFromDb(change_db)}};
    const std::uint64_t seed = options.seed + 2 * i;
    Frame frame;
    frame.image =
        Shown(sim::CoherentPower(geometry, pose, options.truth, {seed, seed + 1}), options.truth.display);
    if (options.with_poses) frame.info.world_from_sonar = pose;
    frames.push_back(std::move(frame));
  }
  info.scale = frames.front().image.scale;
  return {std::move(info), std::move(frames)};
}

}  // namespace sonarcal::testing
