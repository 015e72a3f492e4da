// Responses of the sonar to an echo off the axis in azimuth, elevation or range. Each is a two-way power
// response, 1 on the axis, described by its full width at half power. Range, and elevation with kGaussian,
// have a Gaussian response,
//
//   w(x) = 2^(-(2 x / width)^2)
//
// A peak of 1 keeps the level of a point target. The level of an extended surface then follows from the area
// of the resolution cell. Its equivalent width is the integral of the response: width * sqrt(pi / (4 ln 2)).
//
// Shapes of a beam in azimuth (AzimuthPattern):
//
//   kGaussian  w of the difference in azimuth: a main lobe only.
//   kAperture  A line array of length L wavelengths shaded by (1 - t) + t cos^2(pi s), s = -1/2..1/2, with t
//              the taper. Its field is a sum of three sincs of v = L (sin(echo azimuth) - sin(beam azimuth)),
//                F(v) = sinc(v) + (t / 4) (sinc(v - 1) + sinc(v + 1)) / (1 - t / 2),
//                sinc(x) = sin(pi x) / (pi x),
//              and its power F^2. L gives the beam at broadside its half-power width; other beams are wider
//              by 1 / cos(azimuth), as with a real array. Highest side lobe: -13.26 dB at t = 0, -31.47 dB at
//              t = 1 (Harris, Proc. IEEE 66(1), 1978, Table I). The transmitter is assumed uniform over the
//              field of view.
//   kTable     Levels in dB at whole offsets in beams, linear in dB between them, no response beyond the
//              last. Its field is the square root of its power: the table has no signs.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/types/parameters.h"
#include "core/types/units.h"

namespace sonarcal::sim {

// Response at x. x and half_power_width in the same unit; half_power_width > 0.
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

// sin(pi x) / (pi x). Uses a series near 0, where the quotient and its derivative lose digits.
template <typename T>
T Sinc(const T& x) {
  using std::sin;
  const T y = T(std::numbers::pi) * x;
  const T square = y * y;
  if (square < T(0.1)) {
    return T(1.0) -
           square / 6.0 *
               (T(1.0) - square / 20.0 *
                             (T(1.0) - square / 42.0 * (T(1.0) - square / 72.0 * (T(1.0) - square / 110.0))));
  }
  return sin(y) / y;
}

// d Sinc / dx.
template <typename T>
T SincSlope(const T& x) {
  using std::cos;
  const T y = T(std::numbers::pi) * x;
  const T square = y * y;
  if (square < T(0.1)) {
    return T(-std::numbers::pi) * y / 3.0 *
           (T(1.0) -
            square / 10.0 * (T(1.0) - square / 28.0 * (T(1.0) - square / 54.0 * (T(1.0) - square / 88.0))));
  }
  return (cos(y) - Sinc(x)) / x;
}

// Field of a line aperture shaded by (1 - taper) + taper cos^2, 1 on the axis. v is the length in wavelengths
// times the sine off axis. 0 <= taper <= 1.
template <typename T>
T ApertureField(const T& v, const T& taper) {
  using std::sin;
  const T weight = T(0.25) * taper / (T(1.0) - T(0.5) * taper);
  const T square = v * v;
  const T to_pole = square - T(1.0);
  // If no argument is small, the three sincs share one sine: sin(pi (v +- 1)) = -sin(pi v).
  if (square > T(0.04) && (to_pole > T(0.4) || to_pole < T(-0.4)))
    return sin(T(std::numbers::pi) * v) / (T(std::numbers::pi) * v) *
           (T(1.0) - T(2.0) * weight * square / to_pole);
  return Sinc(v) + weight * (Sinc(v - T(1.0)) + Sinc(v + T(1.0)));
}

// Value v > 0 at which the power of ApertureField is 1/2: 0.4429 at taper 0, 0.7203 at taper 1. Newton's
// method runs in T, so the result carries the derivative by the taper. Pass root_of_half to find the v at
// which the field is 0.5^root_of_half, e.g. 0.25 for an aperture that is used twice.
template <typename T>
T ApertureHalfPower(const T& taper, double root_of_half = 0.5) {
  T v(0.6);
  for (int step = 0; step < 12; ++step) {
    const T sides = SincSlope(v - T(1.0)) + SincSlope(v + T(1.0));
    const T slope = SincSlope(v) + T(0.25) * taper * sides / (T(1.0) - T(0.5) * taper);
    v -= (ApertureField(v, taper) - T(std::pow(0.5, root_of_half))) / slope;
  }
  return v;
}

// Integral of the power of ApertureField over v: 1 at taper 0, 1.5 at taper 1 (Parseval).
template <typename T>
T ApertureEquivalentWidth(const T& taper) {
  const T mean = T(1.0) - T(0.5) * taper;
  return T(1.0) + T(0.125) * taper * taper / (mean * mean);
}

// Azimuth response as a fit uses it. The tables must outlive it.
template <typename T>
struct AzimuthShape {
  AzimuthPattern pattern = AzimuthPattern::kGaussian;
  T width_rad = T(0.0);                           // full width at half power; unused for kTable
  T taper = T(1.0);                               // kAperture
  const std::vector<double>* table_db = nullptr;  // kTable: level at -n..n beams off axis, 2 n + 1 values
  double beam_spacing_rad = 0.0;                  // kTable: an offset of one beam, if beams are evenly spaced
  // kTable: beam centres of unevenly spaced beams (offsets are then counted in beams, as in the table); null:
  // beams are beam_spacing_rad apart.
  const std::vector<double>* beam_azimuth_rad = nullptr;
};

// Position of an azimuth among beam centres (at least two, ascending): i at centre i, linear between and
// beyond.
inline double FractionalBeam(const std::vector<double>& beam_azimuth_rad, double azimuth_rad) {
  const auto above = std::upper_bound(beam_azimuth_rad.begin() + 1, beam_azimuth_rad.end() - 1, azimuth_rad);
  const double left = *(above - 1);
  return static_cast<double>(above - 1 - beam_azimuth_rad.begin()) + (azimuth_rad - left) / (*above - left);
}

// AzimuthShape prepared for many evaluations: the aperture's length is computed once.
template <typename T>
class AzimuthResponse {
 public:
  explicit AzimuthResponse(const AzimuthShape<T>& shape) : shape_(shape) {
    using std::sin;
    if (shape.pattern == AzimuthPattern::kAperture) {
      aperture_wavelengths_ = ApertureHalfPower(shape.taper) / sin(T(0.5) * shape.width_rad);
    }
  }

  // Power response, 1 on the axis.
  T Power(double echo_azimuth_rad, double beam_azimuth_rad) const {
    switch (shape_.pattern) {
      case AzimuthPattern::kAperture: {
        const T field = Field(echo_azimuth_rad, beam_azimuth_rad);
        return field * field;
      }
      case AzimuthPattern::kTable:
        return T(TablePower(echo_azimuth_rad, beam_azimuth_rad));
      case AzimuthPattern::kGaussian:
        break;
    }
    return GaussianResponse(T(echo_azimuth_rad - beam_azimuth_rad), shape_.width_rad);
  }

  // Field of kAperture at a difference of sines (echo minus beam), for callers that keep the sines.
  T ApertureFieldAt(double off_axis) const {
    return ApertureField(T(aperture_wavelengths_ * T(off_axis)), shape_.taper);
  }

  // Field response: its square is Power. Signed for kAperture, whose side lobes alternate.
  T Field(double echo_azimuth_rad, double beam_azimuth_rad) const {
    switch (shape_.pattern) {
      case AzimuthPattern::kAperture: {
        return ApertureFieldAt(std::sin(echo_azimuth_rad) - std::sin(beam_azimuth_rad));
      }
      case AzimuthPattern::kTable:
        return T(std::sqrt(TablePower(echo_azimuth_rad, beam_azimuth_rad)));
      case AzimuthPattern::kGaussian:
        break;
    }
    return GaussianResponse(T(echo_azimuth_rad - beam_azimuth_rad),
                            T(shape_.width_rad * std::numbers::sqrt2));
  }

  const AzimuthShape<T>& shape() const { return shape_; }
  const T& aperture_wavelengths() const { return aperture_wavelengths_; }

 private:
  double TablePower(double echo_azimuth_rad, double beam_azimuth_rad) const {
    const std::vector<double>& table_db = *shape_.table_db;
    const double offset = shape_.beam_azimuth_rad != nullptr
                              ? FractionalBeam(*shape_.beam_azimuth_rad, echo_azimuth_rad) -
                                    FractionalBeam(*shape_.beam_azimuth_rad, beam_azimuth_rad)
                              : (echo_azimuth_rad - beam_azimuth_rad) / shape_.beam_spacing_rad;
    const int last = static_cast<int>(table_db.size()) - 1;
    double position = offset + 0.5 * last;
    const double nearest = std::round(position);
    if (std::abs(position - nearest) < 1e-9) position = nearest;  // centre of a beam, up to rounding
    if (position < 0.0 || position > last) return 0.0;
    const int below = static_cast<int>(position);
    const int above = std::min(below + 1, last);
    const double level_db = table_db[below] + (position - below) * (table_db[above] - table_db[below]);
    return PowerFromDb(level_db);
  }

  AzimuthShape<T> shape_;
  T aperture_wavelengths_ = T(0.0);
};

// Power response of one beam to one echo, 1 on the axis. For many echoes, keep an AzimuthResponse.
template <typename T>
T AzimuthPower(const AzimuthShape<T>& shape, double echo_azimuth_rad, double beam_azimuth_rad) {
  return AzimuthResponse<T>(shape).Power(echo_azimuth_rad, beam_azimuth_rad);
}

// Field of a line aperture shaded by cos(pi s), s = -1/2..1/2, 1 on the axis: cos(pi v) / (1 - 4 v^2), v as
// in ApertureField. Highest side lobe -23 dB (Harris 1978, Table I).
inline double CosineApertureField(double v) {
  const double e = std::abs(v) - 0.5;  // both terms vanish near 0: sin(pi e) / (4 e (1 + e))
  return 0.25 * std::numbers::pi * Sinc(e) / (1.0 + e);
}

// Two-way elevation response of a beam, 1 on the axis, prepared for many evaluations. kAperture and kCosine:
// the field of an aperture on transmit times the same on receive, F(v)^4 in power with v = L sin(elevation).
class ElevationResponse {
 public:
  // width_rad: full width at half power, two-way; 0: no pattern.
  ElevationResponse(ElevationPattern pattern, double width_rad, double taper)
      : pattern_(pattern), width_rad_(width_rad), taper_(taper) {
    if (!(width_rad > 0.0) || pattern == ElevationPattern::kGaussian) return;
    const double half_power =
        pattern == ElevationPattern::kCosine ? kCosineHalfPower : ApertureHalfPower(taper, 0.25);
    aperture_wavelengths_ = half_power / std::sin(0.5 * width_rad);
  }

  double Power(double elevation_rad) const {
    if (!(width_rad_ > 0.0)) return 1.0;
    if (pattern_ == ElevationPattern::kGaussian) return GaussianResponse(elevation_rad, width_rad_);
    const double v = aperture_wavelengths_ * std::sin(elevation_rad);
    const double one_way =
        pattern_ == ElevationPattern::kCosine ? CosineApertureField(v) : ApertureField(v, taper_);
    return one_way * one_way * one_way * one_way;
  }

 private:
  // Value v at which CosineApertureField is 0.5^(1/4).
  static constexpr double kCosineHalfPower = 0.4254963363382263;

  ElevationPattern pattern_;
  double width_rad_;
  double taper_;
  double aperture_wavelengths_ = 0.0;
};

// Elevation at which a pattern's main lobe ends (where it first stops falling), radians, to a thousandth of a
// radian. pi / 2 if there is no side lobe.
double MainLobeEndRad(const ElevationResponse& response);

// Transmitted power outside the field of view (BeamParameters): a factor on the power of an echo that leaves
// the sonar at this azimuth.
class TransmitPattern {
 public:
  explicit TransmitPattern(const BeamParameters& beam)
      : even_rad_(RadFromDeg(beam.transmit_even_deg)), end_rad_(RadFromDeg(beam.transmit_end_deg)) {}

  double Power(double azimuth_rad) const {
    const double beyond_rad = std::abs(azimuth_rad) - even_rad_;
    if (!(end_rad_ > 0.0) || beyond_rad <= 0.0) return 1.0;
    if (!(beyond_rad < end_rad_ - even_rad_)) return 0.0;
    const double pressure = std::cos(0.5 * std::numbers::pi * beyond_rad / (end_rad_ - even_rad_));
    return pressure * pressure;
  }

 private:
  double even_rad_;
  double end_rad_;
};

// Azimuths (lowest, highest) outside which the beam's power response stays below `level_db` < 0. kAperture
// uses the envelope of its side lobes, which lies at most a few dB above them; the result is -pi/2 or pi/2 if
// the side lobes reach that far. A cut at these azimuths loses a fraction of the integral: kGaussian almost
// nothing; kAperture at -60 dB 1.4e-6 at taper 1, 3.2e-4 at taper 0; kTable nothing at any level.
std::pair<double, double> AzimuthReachRad(const AzimuthResponse<double>& response, double beam_azimuth_rad,
                                          double level_db);

// Integral of the power response over azimuth, radians: the width of the resolution cell. kAperture: integral
// over the sine, divided by cos(beam azimuth), which assumes a narrow beam. kTable without beam_azimuth_rad:
// the same for every beam. kTable with it: assumes that the beam's neighbours are as wide as the beam.
double AzimuthEquivalentWidthRad(const AzimuthResponse<double>& response, double beam_azimuth_rad);

}  // namespace sonarcal::sim
