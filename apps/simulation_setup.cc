#include "apps/simulation_setup.h"

#include "sim/acoustic_fan.h"

namespace sonarcal {
namespace {

// Three half-power widths hold the main lobe of every pattern and the side lobes over -35 dB of a Hann-shaded
// array's.
constexpr double kMarginInBeamWidths = 3.0;

double DefaultMarginDeg(const SonarModel& sonar, const ParameterSet& parameters) {
  if (parameters.model == EchoModel::kPaper) return 0.0;
  return kMarginInBeamWidths * (parameters.beam.azimuth_width_deg > 0.0 ? parameters.beam.azimuth_width_deg
                                                                        : sonar.azimuth_beam_width_deg);
}

}  // namespace

SimulationOptions SimulationFor(const RayOptions& rays, const SonarModel& sonar, const Water& water,
                                const ParameterSet& parameters, std::optional<double> margin_deg) {
  SimulationOptions simulation = rays.For(sonar, water, parameters.model);
  if (parameters.model == EchoModel::kAcoustic && rays.rays.empty())
    simulation.fan = AcousticFanOptions(sonar, parameters);
  simulation.fan.azimuth_margin_deg = margin_deg.value_or(DefaultMarginDeg(sonar, parameters));
  return simulation;
}

}  // namespace sonarcal
