// Responses of the sonar to an echo that is off in azimuth, elevation or range. Each is a two-way power
// response, 1 on the axis, of Gaussian shape, named by its full width at half power:
//
//   w(x) = 2^(-(2 x / width)^2)
//
// A peak of 1 keeps the level of a point target; the level of an extended surface then follows from the area
// of the resolution cell, whose equivalent width is the integral of the response: width * sqrt(pi / (4 ln
// 2)).
#pragma once

#include <cmath>
#include <numbers>

namespace sonarcal {

// x and half_power_width in one unit; half_power_width > 0.
template <typename T>
T GaussianResponse(const T& x, const T& half_power_width) {
  using std::exp;
  const T ratio = T(2.0) * x / half_power_width;
  return exp(T(-std::numbers::ln2) * ratio * ratio);
}

// Integral of the response over x.
template <typename T>
T GaussianEquivalentWidth(const T& half_power_width) {
  return half_power_width * T(std::sqrt(std::numbers::pi / (4.0 * std::numbers::ln2)));
}

}  // namespace sonarcal
