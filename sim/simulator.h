// Renders sonar images from a scene, a sonar and poses.
//
// A Simulator holds the data that all frames share: the ray tracer's acceleration structure and the fan of
// rays.
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
#include "core/types/pings.h"
#include "sim/acoustic/acoustic_image.h"
#include "sim/acoustic/expected_frames.h"
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
  // Paper model: range and azimuth errors. Acoustic model: speckle and receiver noise. Coherent images always
  // have both.
  bool noise = false;
  std::uint64_t seed = 1;  // seed of the noise; frame i uses seed + i
  // Acoustic and coherent: the scatterers' phases do not depend on the frame, so speckle stays constant while
  // nothing moves. Receiver noise is new in each frame.
  bool frozen_speckle = false;
  int ghost_order = 1;  // max number of reflections on a multipath, 1 or 2; has no effect without a mirror
  std::vector<PointTarget> point_targets = {};  // coherent only

  void Check() const;
  double full_scale() const { return static_cast<double>((1 << bits) - 1); }
};

class Simulator {
 public:
  // Throws DataError for an unusable option, scene or sonar.
  Simulator(Scene scene, SonarModel sonar, SimulationOptions options);
  // Uses a scene that others trace too; its acceleration structure is built once.
  Simulator(std::shared_ptr<const RayCaster> caster, SonarModel sonar, SimulationOptions options);
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  // Echoes of a pose: geometry only.
  EchoList TraceEchoes(const Pose& world_from_sonar) const;

  // Echoes of a pose, gathered by pixel.
  EchoHistogram GatherEchoes(const Pose& world_from_sonar) const;

  // Multipath echoes of a pose, by the materials that the parameters declare as mirrors. If the scene has no
  // mirror, casts no ray and returns an empty list. Depends on the parameters only through the list of
  // mirrors and the beam fields that GhostFanOptions reads, so losses may change without a new trace.
  // `ray_decimation` divides the number of ray rows and columns.
  GhostList TraceGhosts(const Pose& world_from_sonar, const ParameterSet& parameters,
                        int ray_decimation = 1) const;

  // Image of a pose by the model that the parameters name, in whole grey levels. Like all functions below
  // that return an image, throws DataError if levels add up to more power than single precision holds.
  PolarImage Render(const Pose& world_from_sonar, const ParameterSet& parameters, int frame_idx = 0) const {
    return Render(world_from_sonar, parameters, SeedsOf(frame_idx));
  }
  // The paper's model uses the seed of the receiver.
  PolarImage Render(const Pose& world_from_sonar, const ParameterSet& parameters,
                    const DrawSeeds& seeds) const;

  // Image of a frame whose pings have their own poses (core/types/pings.h): one rendering per ping, of which
  // the frame gets the beams of the ping. Without pings: the image of the pose. The pings see the same
  // scatterers, which stay where they are in the world; each has its own receiver noise.
  PolarImage RenderPings(const Pose& world_from_sonar, const std::vector<PingPose>& pings,
                         const ParameterSet& parameters, int frame_idx = 0) const {
    return RenderPings(world_from_sonar, pings, parameters, SeedsOf(frame_idx));
  }
  PolarImage RenderPings(const Pose& world_from_sonar, const std::vector<PingPose>& pings,
                         const ParameterSet& parameters, const DrawSeeds& seeds) const;

  // Renders echoes that were traced before, and multipath echoes (not for the paper's model). Must not be
  // called for kCoherent, which places scatterers between the rays (SONARCAL_CHECK).
  PolarImage RenderEchoes(const EchoList& echoes, const ParameterSet& parameters, int frame_idx = 0,
                          const GhostList& ghosts = {}) const {
    return RenderEchoes(echoes, parameters, SeedsOf(frame_idx), ghosts);
  }
  PolarImage RenderEchoes(const EchoList& echoes, const ParameterSet& parameters, const DrawSeeds& seeds,
                          const GhostList& ghosts) const;

  // Expected image, not rounded: the mean over range and azimuth errors (paper) or over speckle (acoustic,
  // and coherent, which has the mean power of the acoustic model with AzimuthPattern::kAperture).
  PolarImage RenderExpected(const EchoList& echoes, const ParameterSet& parameters,
                            const GhostList& ghosts = {}) const;

  // Scattered power of the acoustic model, before beam and pulse.
  ScatterMap Scatter(const EchoList& echoes, const ParameterSet& parameters,
                     const GhostList& ghosts = {}) const;

  // Random seeds of frame `frame_idx`. With frozen speckle, the scatterers are those of frame `speckle_idx`.
  DrawSeeds SeedsOf(int frame_idx, int speckle_idx = 0) const;

  const SonarModel& sonar() const { return sonar_; }
  const SimulationOptions& options() const { return options_; }
  const RayFan& fan() const { return fan_; }
  const RayCaster& caster() const { return *caster_; }
  const std::shared_ptr<const RayCaster>& shared_caster() const { return caster_; }
  double absorption_db_per_m() const { return absorption_db_per_m_; }

 private:
  struct Mirrors;
  std::shared_ptr<const Mirrors> MirrorsOf(const ParameterSet& parameters, int ray_decimation = 1) const;
  std::shared_ptr<const ExpectedFrames> ExpectedFramesOf(const ParameterSet& parameters) const;
  PaperImageOptions PaperOptions(std::uint64_t seed) const;
  PolarImage RenderScatter(const ScatterMap& scatter, const ParameterSet& parameters,
                           const DrawSeeds& seeds) const;
  PolarImage RenderCoherent(const Pose& world_from_sonar, const std::vector<PingPose>& pings,
                            const ParameterSet& parameters, const DrawSeeds& seeds) const;
  RayFan FanOfPings(const std::vector<PingPose>& pings) const;
  void RefuseMargin() const;

  SonarModel sonar_;
  SimulationOptions options_;
  std::shared_ptr<const RayCaster> caster_;
  RayFan fan_;
  double absorption_db_per_m_;
  // Data that calls share, made by the last one that needed other data.
  mutable std::mutex shared_mutex_;
  mutable std::map<int, std::shared_ptr<const Mirrors>> mirrors_;  // by `ray_decimation`
  mutable std::shared_ptr<const ExpectedFrames> expected_frames_;
};

}  // namespace sonarcal::sim
