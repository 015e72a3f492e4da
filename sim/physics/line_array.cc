#include "sim/physics/line_array.h"

#include <cmath>
#include <numbers>

#include "core/math/bisection.h"
#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::sim {
namespace {

using Complex = std::complex<double>;

LineArray ArrayOfLength(double wavelengths, int elements, double taper) {
  LineArray array;
  double sum = 0.0;
  for (int i = 0; i < elements; ++i) {
    const double place = (i + 0.5) / elements - 0.5;  // in units of the length
    const double cosine = std::cos(std::numbers::pi * place);
    array.position_wavelengths.push_back(place * wavelengths);
    array.shading.push_back((1.0 - taper) + taper * cosine * cosine);
    sum += array.shading.back();
  }
  for (double& weight : array.shading) weight /= sum;
  return array;
}

}  // namespace

double LineArray::Power(double sine) const {
  Complex sum(0.0);
  for (std::size_t i = 0; i < shading.size(); ++i) {
    sum += std::polar(shading[i], kTwoPi * position_wavelengths[i] * sine);
  }
  return std::norm(sum);
}

LineArray MakeLineArray(double half_power_width_rad, double taper) {
  const double width_deg = DegFromRad(half_power_width_rad);
  if (!(width_deg >= 0.05 && width_deg <= 60.0)) {
    throw DataError("azimuth beam width {} degrees: an array is made for 0.05 .. 60", width_deg);
  }
  if (!(taper >= 0.0 && taper <= 1.0)) throw DataError("beam.azimuth_taper is {}, expected 0 .. 1", taper);
  // For every taper, the main lobe lies between those of half and of twice the wavelength divided by the
  // width.
  const double sine = std::sin(0.5 * half_power_width_rad);
  const auto length_with = [&](int elements, double shortest, double longest) {
    return Bisection(shortest, longest,
                     [&](double length) { return ArrayOfLength(length, elements, taper).Power(sine) > 0.5; });
  };
  const auto elements_within = [](double length) { return static_cast<int>(std::ceil(2.0 * length)); };
  const double length = length_with(elements_within(1.0 / sine), 0.2 / sine, 1.0 / sine);
  // Number of elements for a spacing of half a wavelength. Fewer elements change the width by O(1 / n^2), so
  // the length is found again near the first one.
  constexpr int kMinElements = 4;
  const int elements = std::max(elements_within(length), kMinElements);
  return ArrayOfLength(length_with(elements, 0.9 * length, 1.1 * length), elements, taper);
}

Beamformer::Beamformer(const LineArray& array, const PolarAxes& axes)
    : elements_(static_cast<int>(array.shading.size())), steering_(axes.beam_count(), elements_) {
  double squares = 0.0;
  for (const double weight : array.shading) squares += weight * weight;
  noise_scale_ = 1.0 / std::sqrt(squares);
  for (int beam = 0; beam < axes.beam_count(); ++beam) {
    const double sine = std::sin(axes.beam_azimuth_rad[beam]);
    for (int i = 0; i < elements_; ++i) {
      steering_(beam, i) = std::polar(array.shading[i], -kTwoPi * array.position_wavelengths[i] * sine);
    }
  }
}

Complex Beamformer::Beam(int beam, std::span<const Complex> field) const {
  const auto steering = steering_.row(beam);
  double re = 0.0;
  double im = 0.0;
  for (int i = 0; i < elements_; ++i) {
    re += steering[i].real() * field[i].real() - steering[i].imag() * field[i].imag();
    im += steering[i].real() * field[i].imag() + steering[i].imag() * field[i].real();
  }
  return {re, im};
}

}  // namespace sonarcal::sim
