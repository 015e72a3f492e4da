// Power of multipath echoes (sim/ghosts/ghost_trace.h), added to the power that a scene scatters. An echo
// that goes out by leg a and comes back by leg b, of lengths L and spreading distances S, has the mean power
//
//   10^((SL + G - alpha (La + Lb)) / 10) / (Sa Sb)^2  10^(-(losses of all reflections) / 10)
//     sigma(delta_a, delta_b)  A  sqrt(el(phi_a) el(phi_b))
//
// at range (La + Lb) / 2, from the azimuth of b. A = Sa^2 dOmega / cos(delta_a) is the patch of the ray that
// found it. Each end has half of the two-way elevation pattern (in dB). Between two directions a surface
// scatters by GsabBetweenPower (sim/physics/gsab.h).
//
// The two directions of travel along one pair of legs have the same length, so for each scatterer the two
// echoes arrive in phase. A beam receives the field f(h) + f(-h), where h is half the difference of their
// azimuths. If both come from one direction, as with a floor or the water surface, this is four times the
// power of one echo (enhanced backscatter). A third arrival therefore represents the product term: at the
// mean azimuth, with twice the power of one echo times the response at h. This is exact for Gaussian beams,
// and for others as far as their main lobe is Gaussian. Echoes of different lengths have independent phases:
// their powers add.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/types/parameters.h"
#include "sim/acoustic/acoustic_image.h"
#include "sim/ghosts/ghost_trace.h"
#include "sim/physics/beam_pattern.h"

namespace sonarcal::sim {

// One arrival of a multipath echo at the sonar; power as in a ScatterMap.
struct GhostArrival {
  double range_m = 0.0;
  double azimuth_rad = 0.0;
  double power = 0.0;
};

class GhostPower {
 public:
  // The arguments must outlive it. Throws DataError if the beam's azimuth width is unknown.
  GhostPower(const std::vector<std::string>& material_names, const AcousticGeometry& geometry,
             const ParameterSet& parameters);

  // Tabulates the elevation response, for lists of many echoes. Linear interpolation differs from it by at
  // most 1e-5 of its peak.
  void TabulateElevations();

  // Power in one direction of travel: out by `leg`, back by `other`.
  double OneWay(const GhostEcho& echo) const;

  // OneWay of each echo, to single precision.
  std::vector<double> OneWays(std::span<const GhostEcho> echoes) const;

  // As OneWay with source level, gain, losses and backscatter set to 1: the factor of the geometry.
  double UnitOneWay(const GhostEcho& echo) const;

  // Calls take(GhostArrival) for each arrival: one, or three if the echo travels both ways.
  template <typename Take>
  void ForEachArrival(const GhostEcho& echo, Take&& take) const {
    ForEachArrival(echo, OneWay(echo), take);
  }

  // As above, with `power` = OneWay(echo) known.
  template <typename Take>
  void ForEachArrival(const GhostEcho& echo, double power, Take&& take) const {
    const double range_m = echo.range_m();
    const float azimuth_rad = echo.leg.azimuth_rad;
    const float other_rad = echo.other.azimuth_rad;
    const double sent = transmit_.Power(azimuth_rad);
    const double sent_by_other = transmit_.Power(other_rad);
    take(GhostArrival{range_m, azimuth_rad, power * sent_by_other});
    if (!echo.both_ways) return;
    take(GhostArrival{range_m, other_rad, power * sent});
    const float middle_rad = 0.5F * (azimuth_rad + other_rad);
    const double in_common = InCommon(azimuth_rad, middle_rad);
    if (in_common > 0.0) {
      take(GhostArrival{range_m, middle_rad, 2.0 * power * std::sqrt(sent * sent_by_other) * in_common});
    }
  }

 private:
  double LossDb(const GhostLeg& leg) const;
  EchoPath PathOf(const GhostEcho& echo) const;
  // Share of the power that the mirrors of a leg reflect.
  double MirrorFactor(const GhostLeg& leg) const;
  double ElevationPower(double elevation_rad) const;
  // Response at the mean azimuth to an echo at `azimuth_rad`; 0 if negligible.
  double InCommon(float azimuth_rad, float middle_rad) const;

  EchoPowerModel model_;
  std::vector<GsabParameters<float>> curves_;  // of the materials; images need no double precision
  AzimuthResponse<double> azimuth_;
  TransmitPattern transmit_;
  std::vector<double> elevation_table_;  // over -90 .. 90 degrees; empty: not tabulated
  double elevation_width_deg_;
  double negligible_beyond_rad_ = 0.0;  // difference of azimuths beyond which InCommon is 0
  std::vector<double> reflected_;       // per material, share of the power; 0 if it is no mirror
};

// Grid of a fan's columns and fine rows of range. An arrival is shared between the two nearest columns and
// rows. Arrivals outside the grid are dropped; up to half a step beyond either end counts as the end.
class ArrivalGrid {
 public:
  // `column_azimuth_rad` must outlive it.
  ArrivalGrid(const std::vector<double>& column_azimuth_rad, const FineRows& rows)
      : columns_(column_azimuth_rad), rows_(rows) {}

  // Calls take(row, column, nearer, further) for up to two columns: powers of `row` and of the next row. The
  // latter is 0 if there is none.
  template <typename Take>
  void ForEachColumn(const GhostArrival& arrival, Take&& take) const {
    const auto column = Place(arrival.azimuth_rad);
    if (!column) return;
    int first = -1;
    double powers[2] = {};
    rows_.Share(arrival.range_m, arrival.power, [&](int row, double of_row) {
      if (first < 0) first = row;
      powers[row - first] = of_row;
    });
    if (first < 0) return;
    const double fraction = column->fraction;
    take(first, column->index, (1.0 - fraction) * powers[0], (1.0 - fraction) * powers[1]);
    take(first, column->index + 1, fraction * powers[0], fraction * powers[1]);
  }

  // Calls take(row, column, power) for up to four cells.
  template <typename Take>
  void ForEachCell(const GhostArrival& arrival, Take&& take) const {
    const auto column = Place(arrival.azimuth_rad);
    if (!column) return;
    rows_.Share(arrival.range_m, arrival.power, [&](int row, double of_row) {
      take(row, column->index, (1.0 - column->fraction) * of_row);
      take(row, column->index + 1, column->fraction * of_row);
    });
  }

 private:
  // Index, and fraction of the distance to the next.
  struct Between {
    int index = 0;
    double fraction = 0.0;
  };
  std::optional<Between> Place(double azimuth_rad) const;

  const std::vector<double>& columns_;
  FineRows rows_;
};

// Adds the list to a map. An arrival between two columns or rows is shared between them; arrivals outside the
// map are dropped.
void AddGhosts(const GhostList& ghosts, const AcousticGeometry& geometry, const ParameterSet& parameters,
               ScatterMap& scatter);

// As above, through the pulse of the parameters.
void AddGhosts(const GhostList& ghosts, const AcousticGeometry& geometry, const ParameterSet& parameters,
               PulsedMap& pulsed);

}  // namespace sonarcal::sim
