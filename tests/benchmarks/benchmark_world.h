// What the benchmarks of a frame share: the scene, the sonar's options, a clock.
#pragma once

#include <chrono>
#include <vector>

#include "core/math/statistics.h"
#include "sim/scenes/scenes.h"
#include "sim/scenes/sonar_presets.h"
#include "sim/simulator.h"

namespace sonarcal::benchmarks {

inline double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The paper's tank, its mock-ups of this many triangles each.
inline Scene Tank(int triangles) {
  sim::MockupTankOptions options = sim::MockupTankOfSize(sim::SizeVariant::kStandard);
  options.mockup = sim::RefinedTo(options.mockup, triangles);
  return sim::MakeMockupTank(options);
}

inline ParameterSet Parameters() {
  ParameterSet parameters;
  parameters.display = {.db_min = 150.0, .db_max = 153.0};
  parameters.materials["default"];
  parameters.jitter = {.sigma_range_m = 0.0127, .sigma_azimuth_deg = 0.5};
  return parameters;
}

inline sim::SimulationOptions Options(const sim::SonarPreset& preset, const sim::RayFanOptions& fan) {
  sim::SimulationOptions options;
  options.fan = fan;
  options.water = preset.water;
  options.noise = true;
  return options;
}

inline constexpr sim::RayFanOptions kPaperRays = {
    .sampling = sim::Sampling::kFrustum, .cols = 1500, .rows = 1200};

}  // namespace sonarcal::benchmarks
