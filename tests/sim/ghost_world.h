// What the tests of ghosts look with: a sonar, parameters by which only objects scatter and only mirrors
// reflect, and the steps from a scene to the power of its ghosts.
#pragma once

#include "sim/ghosts/ghost_power.h"
#include "tests/sim/meshes.h"
#include "tests/sim/slow_acoustic_model.h"
#include "tests/sim/slow_paper_model.h"
#include "tests/sim/water.h"

namespace sonarcal::testing {

inline constexpr double kGhostAzimuthWidthDeg = 1.6;
inline constexpr double kGhostElevationWidthDeg = 24.0;
inline constexpr double kPulseM = 0.1;
inline constexpr double kLossDb = 4.5;
inline constexpr int kGhostBeams = 64;
inline constexpr int kGhostBins = 60;

// 64 beams of 0.8 degrees; 60 bins of 5 cm from 2.5 m on.
inline SonarModel GhostSonar() {
  SonarModel sonar =
      MakeSonar(EvenAzimuthsDeg(kGhostBeams, 0.8), kGhostElevationWidthDeg, 2.5, 5.5, kGhostBins);
  sonar.azimuth_beam_width_deg = kGhostAzimuthWidthDeg;
  return sonar;
}

// Objects scatter; mirrors do nothing else.
inline ParameterSet GhostParameters() {
  ParameterSet p = ClosedFormParameters(9.0);
  p.materials["mirror"].gsab = {.a = 0.0, .b_deg = 1.0, .c = 0.0, .d = 1.0, .e = 0.0, .f_deg = 1.0};
  p.mirrors["mirror"].loss_db = kLossDb;
  p.pulse.length_m = kPulseM;
  return p;
}

struct GhostAcoustics {
  SonarModel sonar = GhostSonar();
  ParameterSet parameters = GhostParameters();

  sim::AcousticGeometry geometry() const { return {sonar, kAlphaDbPerM}; }
  sim::RayFan Fan(int cols, int rows) const {
    return {sonar,
            {.sampling = sim::Sampling::kBeams, .cols = cols, .rows = rows, .elevation_span_deg = 60.0}};
  }
  sim::GhostList Trace(const Scene& scene, const Pose& pose, const sim::RayFan& fan, int order = 1) const {
    const sim::RayCaster caster(scene);
    const sim::MirrorSurface mirrors(caster.scene(),
                                     sim::ReflectingMaterials(caster.material_names(), parameters));
    return sim::TraceGhosts(caster, mirrors, fan, pose,
                            {.order = order, .range_min_m = 0.5, .range_max_m = 8.0});
  }
  // Of the ghosts alone, through beam and pulse.
  Grid<float> Power(const sim::GhostList& ghosts) const {
    const sim::RayFan fan = Fan(4 * kGhostBeams, 1);
    sim::ScatterMap scatter = sim::MakeScatterMap(Nothing(fan), fan, geometry(), parameters);
    sim::AddGhosts(ghosts, geometry(), parameters, scatter);
    return sim::ExpectedPower(scatter, geometry(), parameters).value;
  }

 private:
  static sim::EchoList Nothing(const sim::RayFan& fan) {
    sim::EchoList echoes;
    echoes.cols = fan.cols();
    return echoes;
  }
};

}  // namespace sonarcal::testing
