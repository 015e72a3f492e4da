// What ghosts (sim/ghost_trace.h) add to the power that a scene scatters. An echo that goes out by leg a and
// comes back by leg b, of lengths L, spreading S, has the mean power
//
//   10^((SL + G - alpha (La + Lb)) / 10) / (Sa Sb)^2  10^(-(losses of all reflections) / 10)
//     sigma(delta_a, delta_b)  A  sqrt(el(phi_a) el(phi_b))
//
// at range (La + Lb) / 2, from the azimuth of b. A = Sa^2 dOmega / cos(delta_a) is the patch of the ray that
// found it. Each end has half of the two-way elevation pattern. Between two directions a surface scatters by
// GsabBetweenPower (sim/physics/gsab.h).
//
// The two ways of one pair of legs have the same length, so that for each scatterer the two echoes arrive in
// phase. A beam that hears both, from azimuths h to either side of their middle, hears the field f(h) + f(-h)
// and not twice the power: where both come from one direction, as by a floor or the surface of the water,
// four times the power of one (the enhancement of backscatter). Beside the two echoes a third stands for the
// product, at the middle and of twice the power of one times the response at h. For Gaussian beams that is
// exact; for others as far as their main lobe is one. Echoes of different lengths have phases apart: their
// powers add.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "data_io/types/parameters.h"
#include "sim/acoustic_image.h"
#include "sim/ghost_trace.h"
#include "sim/physics/beam_pattern.h"

namespace sonarcal {

// One arrival of a ghost at the sonar: power as in a ScatterMap.
struct GhostArrival {
  double range_m = 0.0;
  double azimuth_rad = 0.0;
  double power = 0.0;
};

class GhostPower {
 public:
  // The arguments must outlive it. Throws DataError where the beam's azimuth width is unknown.
  GhostPower(const std::vector<std::string>& material_names, const AcousticGeometry& geometry,
             const ParameterSet& parameters);

  // Of one way, out by `leg` and back by `other`.
  double OneWay(const GhostEcho& echo) const;

  // Calls take(GhostArrival) for each: one, or three where the echo goes both ways.
  template <typename Take>
  void ForEachArrival(const GhostEcho& echo, Take&& take) const {
    ForEachArrival(echo, OneWay(echo), take);
  }

  // The same where OneWay is known.
  template <typename Take>
  void ForEachArrival(const GhostEcho& echo, double power, Take&& take) const {
    const double range_m = echo.range_m();
    const double azimuth_rad = echo.leg.azimuth_rad;
    const double other_rad = echo.other.azimuth_rad;
    const double sent = transmit_.Power(azimuth_rad);
    const double sent_by_other = transmit_.Power(other_rad);
    take(GhostArrival{range_m, azimuth_rad, power * sent_by_other});
    if (!echo.both_ways) return;
    take(GhostArrival{range_m, other_rad, power * sent});
    const double middle_rad = 0.5 * (azimuth_rad + other_rad);
    const double in_common = InCommon(azimuth_rad, middle_rad);
    if (in_common > 0.0) {
      take(GhostArrival{range_m, middle_rad, 2.0 * power * std::sqrt(sent * sent_by_other) * in_common});
    }
  }

 private:
  double OfLeg(const GhostLeg& leg) const;
  // 0 where next to nothing.
  double InCommon(double azimuth_rad, double middle_rad) const;

  double level_;
  double absorption_db_per_m_;
  ElevationResponse elevation_;
  AzimuthResponse<double> azimuth_;
  TransmitPattern transmit_;
  std::vector<GsabParameters<double>> materials_;
  std::vector<double> loss_db_;  // of a reflection by each material; infinity where it is no mirror
};

// Adds the list to a map. What arrives between two columns or rows is shared between them; outside of them
// it is not heard.
void AddGhosts(const GhostList& ghosts, const AcousticGeometry& geometry, const ParameterSet& parameters,
               ScatterMap& scatter);

}  // namespace sonarcal
