#include "core/types/image.h"

#include <algorithm>
#include <cmath>

namespace sonarcal {

std::vector<double> PolarAxes::BeamEdgesRad() const {
  const std::size_t n = beam_azimuth_rad.size();
  SONARCAL_CHECK(n >= 2, "{} beams; edges need at least two", n);
  std::vector<double> edges(n + 1);
  for (std::size_t i = 1; i < n; ++i) edges[i] = 0.5 * (beam_azimuth_rad[i - 1] + beam_azimuth_rad[i]);
  edges[0] = 2.0 * beam_azimuth_rad[0] - edges[1];
  edges[n] = 2.0 * beam_azimuth_rad[n - 1] - edges[n - 1];
  return edges;
}

bool PolarAxes::Matches(const PolarAxes& other, std::string* why) const {
  const auto differ = [&](std::string text) {
    if (why != nullptr) *why = std::move(text);
    return false;
  };
  if (range_bins != other.range_bins) {
    return differ(fmt::format("range bins {} and {}", range_bins, other.range_bins));
  }
  if (beam_count() != other.beam_count()) {
    return differ(fmt::format("beams {} and {}", beam_count(), other.beam_count()));
  }
  const double range_tolerance_m = 1e-3 * range_bin_m();
  if (std::abs(range_min_m - other.range_min_m) > range_tolerance_m ||
      std::abs(range_max_m - other.range_max_m) > range_tolerance_m) {
    return differ(fmt::format("range windows {:.4f}..{:.4f} m and {:.4f}..{:.4f} m", range_min_m, range_max_m,
                              other.range_min_m, other.range_max_m));
  }
  const double azimuth_tolerance_rad =
      1e-3 * std::abs(beam_azimuth_rad.back() - beam_azimuth_rad.front()) / beam_count();
  for (int i = 0; i < beam_count(); ++i) {
    if (std::abs(beam_azimuth_rad[i] - other.beam_azimuth_rad[i]) > azimuth_tolerance_rad) {
      return differ(fmt::format("the azimuths of beam {}, {:.4f} and {:.4f} rad", i, beam_azimuth_rad[i],
                                other.beam_azimuth_rad[i]));
    }
  }
  return true;
}

void PolarAxes::Validate(const std::string& what) const {
  if (!(std::isfinite(range_min_m) && std::isfinite(range_max_m) && range_min_m >= 0.0 &&
        range_max_m > range_min_m)) {
    throw DataError("{}: range window {} .. {} m, expected 0 <= minimum < maximum", what, range_min_m,
                    range_max_m);
  }
  if (range_bins < 1) throw DataError("{}: {} range bins, expected at least 1", what, range_bins);
  if (beam_count() < 2) throw DataError("{}: {} beams, expected at least 2", what, beam_count());
  for (int i = 0; i < beam_count(); ++i) {
    if (!std::isfinite(beam_azimuth_rad[i]) || std::abs(beam_azimuth_rad[i]) > 3.1416) {
      throw DataError("{}: azimuth of beam {} is {} rad, expected a finite angle within +-180 degrees", what,
                      i, beam_azimuth_rad[i]);
    }
    if (i > 0 && !(beam_azimuth_rad[i] > beam_azimuth_rad[i - 1])) {
      throw DataError("{}: azimuth of beam {} is not greater than that of beam {}; expected left to right",
                      what, i, i - 1);
    }
  }
}

std::string_view ToString(Quantity quantity) {
  switch (quantity) {
    case Quantity::kGrey:
      return "grey level";
    case Quantity::kDecibel:
      return "decibel";
    case Quantity::kPower:
      return "power";
    case Quantity::kDepth:
      return "depth";
  }
  return "unknown quantity";
}

}  // namespace sonarcal
