// Receiver of a sonar as a line array along X, and beamforming with it.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "core/types/image.h"

namespace sonarcal::sim {

struct LineArray {
  std::vector<double> position_wavelengths;  // per element along X, symmetric about 0
  std::vector<double> shading;               // weight per element; sum 1

  // |sum of shading x exp(2 pi i position sine)|^2: 1 on the axis.
  double Power(double sine) const;
};

// Throws DataError for a half-power width outside 0.05..60 degrees or a taper outside 0..1.
LineArray MakeLineArray(double half_power_width_rad, double taper);

// Shaded sums over the elements, each beam steered to its centre.
class Beamformer {
 public:
  Beamformer(const LineArray& array, const PolarAxes& axes);

  int elements() const { return elements_; }

  // Factor that gives the beams unit noise power if each element has unit noise power.
  double noise_scale() const { return noise_scale_; }

  // Beam from the fields at the elements.
  std::complex<double> Beam(int beam, std::span<const std::complex<double>> field) const;

 private:
  int elements_;
  Grid<std::complex<double>> steering_;  // beams x elements
  double noise_scale_ = 1.0;
};

}  // namespace sonarcal::sim
