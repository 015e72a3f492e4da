// A scene, a sonar and a pose in; an image out.
//
// A Simulator holds what does not change from frame to frame: the ray tracer's structure and the fan of rays.
//
//   Simulator simulator(scene, sonar, options);
//   PolarImage image = simulator.Render(world_from_sonar, parameters, frame_idx);
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/types/parameters.h"
#include "sim/acoustic/acoustic_image.h"
#include "sim/coherent/coherent_image.h"
#include "sim/ghosts/ghost_trace.h"
#include "sim/paper/expected_paper_image.h"
#include "sim/paper/paper_image.h"
#include "sim/physics/absorption.h"
#include "sim/rays/trace.h"

namespace sonarcal::sim {

struct SimulationOptions {
  RayFanOptions fan;
  TraceOptions trace;
  AbsorptionFormula absorption = AbsorptionFormula::kAuto;
  Water water;
  int bits = 8;  // 8, 12 or 16: the image's full scale is 2^bits - 1
  // Paper: range and azimuth errors; acoustic: speckle and receiver noise. Coherent images have both in any
  // case.
  bool noise = false;
  std::uint64_t seed = 1;  // of the noise; frame i uses seed + i
  // Acoustic and coherent: the scatterers' phases come from `seed` in every frame, so that speckle stays as
  // long as nothing moves; receiver noise is fresh in each.
  bool frozen_speckle = false;
  int ghost_order = 1;  // of the paths by mirrors that are followed, 1 or 2; none without a mirror

  void Check() const;
  double full_scale() const { return static_cast<double>((1 << bits) - 1); }
};

class Simulator {
 public:
  // Throws DataError for options, a scene or a sonar that cannot be used.
  Simulator(Scene scene, SonarModel sonar, SimulationOptions options);
  // Of a scene that others trace as well, its structure built once.
  Simulator(std::shared_ptr<const RayCaster> caster, SonarModel sonar, SimulationOptions options);
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  // The echoes of a pose: geometry only.
  EchoList TraceEchoes(const Pose& world_from_sonar) const;

  // The ghosts of a pose by the materials that the parameters call mirrors; where the scene has none of them
  // no ray is cast and the list is empty. Of the parameters only which mirrors there are counts, and of the
  // beam what GhostFanOptions takes: losses may change without tracing again. `thin`: by so many times fewer
  // rows and columns of rays.
  GhostList TraceGhosts(const Pose& world_from_sonar, const ParameterSet& parameters, int thin = 1) const;

  // The image of a pose by the model that the parameters name, in whole grey levels.
  PolarImage Render(const Pose& world_from_sonar, const ParameterSet& parameters, int frame_idx = 0) const;

  // The same from echoes that were traced before, and ghosts (not of the paper's model). Not for kCoherent,
  // whose scatterers lie between the rays: a programmer's mistake.
  PolarImage RenderEchoes(const EchoList& echoes, const ParameterSet& parameters, int frame_idx = 0,
                          const GhostList& ghosts = {}) const;

  // What every pixel would show on average, over range and azimuth errors (paper) or speckle (acoustic, and
  // coherent, which has the same mean power); not rounded.
  PolarImage RenderExpected(const EchoList& echoes, const ParameterSet& parameters,
                            const GhostList& ghosts = {}) const;

  // What the acoustic model sends through beam and pulse.
  ScatterMap Scatter(const EchoList& echoes, const ParameterSet& parameters,
                     const GhostList& ghosts = {}) const;

  // Of a frame's random numbers.
  DrawSeeds SeedsOf(int frame_idx) const;

  const SonarModel& sonar() const { return sonar_; }
  const SimulationOptions& options() const { return options_; }
  const RayFan& fan() const { return fan_; }
  const RayCaster& caster() const { return *caster_; }
  double absorption_db_per_m() const { return absorption_db_per_m_; }

 private:
  struct Mirrors;
  std::shared_ptr<const Mirrors> MirrorsOf(const ParameterSet& parameters, int thin = 1) const;
  PaperImageOptions PaperOptions(int frame_idx) const;
  PolarImage RenderScatter(const ScatterMap& scatter, const ParameterSet& parameters, int frame_idx) const;
  void RefuseMargin() const;

  SonarModel sonar_;
  SimulationOptions options_;
  std::shared_ptr<const RayCaster> caster_;
  RayFan fan_;
  double absorption_db_per_m_;
  mutable std::mutex mirrors_mutex_;
  mutable std::map<int, std::shared_ptr<const Mirrors>>
      mirrors_;  // by `thin`, of the materials last asked for
};

}  // namespace sonarcal::sim
