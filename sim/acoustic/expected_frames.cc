#include "sim/acoustic/expected_frames.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "sim/physics/display.h"

namespace sonarcal::sim {

ExpectedFrames::ExpectedFrames(const RayCaster& caster, const RayFan& fan, const AcousticGeometry& geometry,
                               const ParameterSet& parameters, const TraceOptions& options)
    : caster_(caster),
      fan_(fan),
      geometry_(geometry),
      parameters_(parameters),
      options_(options),
      azimuth_(AzimuthWindows(geometry.sonar, parameters, ColumnAzimuthsRad(fan), ResponseOf::kPower)),
      gain_(GainByBin(geometry, parameters)),
      noise_(NoiseFloorPower(geometry, parameters)),
      mean_display_(parameters.display, parameters.receiver.looks) {
  if (CastsInOnePass(fan, options)) in_one_pass_.emplace(fan, geometry, parameters, caster.material_names());
}

PulsedMap ExpectedFrames::Pulsed(const Pose& world_from_sonar) const {
  if (in_one_pass_) return in_one_pass_->Cast(caster_, world_from_sonar);
  const EchoList echoes = Trace(caster_, fan_, world_from_sonar, geometry_.sonar.axes, options_);
  const Grid<double> power =
      ThroughPulse(MakeScatterMap(echoes, fan_, geometry_, parameters_), geometry_, parameters_);
  PulsedMap pulsed{Grid<float>(power.rows(), power.cols()), ColumnAzimuthsRad(fan_)};
  std::transform(power.values().begin(), power.values().end(), pulsed.power.values().begin(),
                 [](double value) { return static_cast<float>(value); });
  return pulsed;
}

PolarImage ExpectedFrames::Displayed(const PulsedMap& pulsed, double full_scale) const {
  PolarImage image{geometry_.sonar.axes, GreyScale(parameters_.display, full_scale),
                   azimuth_.Filter(pulsed.power)};
  tbb::parallel_for(tbb::blocked_range<int>(0, image.value.rows(), 8),
                    [&](const tbb::blocked_range<int>& bins) {
                      for (int bin = bins.begin(); bin != bins.end(); ++bin) {
                        for (int beam = 0; beam < image.value.cols(); ++beam) {
                          float& value = image.value(bin, beam);
                          const double power = gain_[bin] * value + noise_(bin, beam);
                          value = static_cast<float>(full_scale * mean_display_(power));
                        }
                      }
                    });
  return image;
}

}  // namespace sonarcal::sim
