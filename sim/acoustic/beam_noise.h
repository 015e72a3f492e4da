// Receiver noise, correlated between beams.
//
// An array forms each beam as a shaded sum over its elements. The noise of one element enters every beam, so
// the noise of two beams is correlated by the overlap of their weights: the array factor of the squared
// shading at the difference of their sines. White noise from all directions that enters through the field
// response of each beam has the same correlation; this is the method used here. The response of an aperture
// of L wavelengths, as a function of L sin(azimuth), is band-limited, so one direction per unit is exact.
// Behind a lens, each beam has its own element and independent noise.
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
  // Throws DataError if an array's beam width is unknown.
  BeamNoise(const SonarModel& sonar, const ParameterSet& parameters);

  // Circular complex Gaussian noise of the beams of a bin, each of unit mean power. Independent between bins.
  // Depends only on `random` and `bin`.
  void Draw(const CounterRandom& random, int bin, std::span<std::complex<double>> beams) const;

 private:
  int sources_ = 0;  // independent numbers per bin
  // weights of each beam for the sources, squares sum to 1; independent beams: empty
  std::vector<ResponseWindow> weights_;
};

}  // namespace sonarcal::sim
