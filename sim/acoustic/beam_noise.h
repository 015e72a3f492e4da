// Receiver noise from beam to beam.
//
// An array forms each beam as a shaded sum over its elements. The noise of one element enters every beam, so
// that the noise of two beams is correlated by the overlap of their weights: the array factor of the squared
// shading at the difference of their sines. The same comes out of white noise from all directions that enters
// through the field response of each beam, which is how it is made here: for an aperture of L wavelengths,
// whose response as a function of L sin(azimuth) is band-limited, one direction per unit is exact. Behind a
// lens each beam has an element, and noise, of its own.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "core/math/random.h"
#include "core/types/parameters.h"
#include "core/types/sonar_model.h"
#include "sim/physics/beam_and_pulse.h"

namespace sonarcal::sim {

class BeamNoise {
 public:
  // Throws DataError where an array's beam width is unknown.
  BeamNoise(const SonarModel& sonar, const ParameterSet& parameters);

  // Circular complex Gaussian noise of the beams of a bin, of unit mean power each; from bin to bin
  // independent. It depends on `random` and `bin` alone.
  void Draw(const CounterRandom& random, int bin, std::span<std::complex<double>> beams) const;

 private:
  int sources_ = 0;                      // independent numbers per bin
  std::vector<ResponseWindow> weights_;  // of each beam for the sources, squares of sum 1; lens: empty
};

}  // namespace sonarcal::sim
