#include "apps/background_law_of.h"

#include "sim/physics/display.h"
#include "sim/physics/receiver.h"

namespace sonarcal {

BackgroundLaw BackgroundLawOf(const ParameterSet& parameters, const PolarAxes& axes,
                              const std::string& where) {
  const ReceiverParameters& receiver = parameters.receiver;
  if (!receiver.noise_db && !receiver.noise_after_gain_db) {
    throw DataError("{}: receiver has no noise floor, expected the parameters that fit --noise-only writes",
                    where);
  }
  constexpr double kAbsorptionDbPerM = 0.0;
  BackgroundLaw law{Grid<float>(axes.range_bins, axes.beam_count()), receiver.looks, {}};
  try {
    const ReceiverNoise noise(receiver, axes, kAbsorptionDbPerM);
    for (int bin = 0; bin < axes.range_bins; ++bin) {
      for (int beam = 0; beam < axes.beam_count(); ++beam) {
        law.mean_power(bin, beam) = static_cast<float>(noise.Power(bin, beam));
      }
    }
  } catch (const DataError& error) {
    throw DataError("{}: {}", where, error.what());
  }
  law.power_of_value = [display = parameters.display](double value) {
    return PowerFromDisplay(display, value);
  };
  return law;
}

}  // namespace sonarcal
