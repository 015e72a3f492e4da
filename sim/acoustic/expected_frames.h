// Expected images of the acoustic model for one scene, fan, sonar and set of parameters. What does not depend
// on the pose is computed once: tables of backscatter and elevation, responses, gain, noise and display.
#pragma once

#include <optional>
#include <vector>

#include "sim/acoustic/acoustic_frame.h"
#include "sim/acoustic/azimuth_filter.h"
#include "sim/physics/speckle.h"

namespace sonarcal::sim {

class ExpectedFrames {
 public:
  // Caster, fan and sonar must outlive this. Throws DataError if the parameters do not fit the scene or the
  // sonar.
  ExpectedFrames(const RayCaster& caster, const RayFan& fan, const AcousticGeometry& geometry,
                 const ParameterSet& parameters, const TraceOptions& options);

  const ParameterSet& parameters() const { return parameters_; }

  // Power of the echoes of a pose through the pulse. Casts in one pass if the fan and the normals permit it,
  // otherwise traces a list of echoes.
  PulsedMap Pulsed(const Pose& world_from_sonar) const;

  // Expected display value of each pixel, not rounded: ExpectedDisplay(ExpectedPower(...)) of
  // sim/acoustic/acoustic_image.h to single precision.
  PolarImage Displayed(const PulsedMap& pulsed, double full_scale) const;

 private:
  const RayCaster& caster_;
  const RayFan& fan_;
  AcousticGeometry geometry_;
  ParameterSet parameters_;
  TraceOptions options_;
  std::optional<PulsedCaster> in_one_pass_;
  AzimuthFilter<float> azimuth_;
  std::vector<double> gain_;  // per range bin
  Grid<double> noise_;        // range bins x beams
  MeanDisplayTable mean_display_;
};

}  // namespace sonarcal::sim
