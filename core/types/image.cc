#include "core/types/image.h"

#include <algorithm>
#include <cmath>

namespace sonarcal {

double PolarAxes::BeamEdgeRad(int edge) const {
  const std::vector<double>& centre = beam_azimuth_rad;
  const int beams = beam_count();
  SONARCAL_CHECK(beams >= 2, "{} beams; edges need at least two", beams);
  SONARCAL_CHECK(edge >= 0 && edge <= beams, "edge {} of {} beams", edge, beams);
  if (edge == 0) return 2.0 * centre[0] - BeamEdgeRad(1);
  if (edge == beams) return 2.0 * centre[beams - 1] - BeamEdgeRad(beams - 1);
  return 0.5 * (centre[edge - 1] + centre[edge]);
}

std::vector<double> PolarAxes::BeamEdgesRad() const {
  std::vector<double> edges;
  for (int edge = 0; edge <= beam_count(); ++edge) edges.push_back(BeamEdgeRad(edge));
  return edges;
}

int PolarAxes::BinAt(double range_m) const {
  const double bin = std::floor((range_m - range_min_m) / range_bin_m());
  if (!(bin >= 0.0)) return -1;
  return bin < range_bins ? static_cast<int>(bin) : range_bins;
}

int PolarAxes::BeamAt(double azimuth_rad) const {
  const auto above = std::upper_bound(beam_azimuth_rad.begin(), beam_azimuth_rad.end(), azimuth_rad);
  const int right = static_cast<int>(above - beam_azimuth_rad.begin());  // first centre to the right
  return azimuth_rad < BeamEdgeRad(right) ? right - 1 : right;
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
