#include "sim/ghost_power.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "data_io/types/units.h"
#include "sim/beam_and_pulse.h"
#include "sim/physics/gsab.h"
#include "sim/physics/patch.h"
#include "sim/physics/propagation.h"

namespace sonarcal {
namespace {

constexpr double kLeastInCommon = 1e-6;

// Where a value lies among increasing positions: index and fraction of the way to the next. Half a step
// beyond either end still counts as the end.
struct Between {
  int index = 0;
  double fraction = 0.0;
};

std::optional<Between> Place(const std::vector<double>& positions, double value) {
  const int last = static_cast<int>(positions.size()) - 1;
  if (last < 1) return std::nullopt;
  const auto above = std::upper_bound(positions.begin() + 1, positions.end() - 1, value);
  const int index = static_cast<int>(above - positions.begin()) - 1;
  const double fraction = (value - positions[index]) / (*above - positions[index]);
  // Rounding of single precision apart.
  if (fraction < -0.5001 || fraction > 1.5001) return std::nullopt;
  return Between{index, std::clamp(fraction, 0.0, 1.0)};
}

}  // namespace

GhostPower::GhostPower(const std::vector<std::string>& material_names, const AcousticGeometry& geometry,
                       const ParameterSet& parameters)
    : level_(PowerFromDb(parameters.source_level_db + parameters.receiver.gain_db)),
      absorption_db_per_m_(geometry.absorption_db_per_m),
      elevation_(ElevationResponseOf(geometry.sonar, parameters)),
      azimuth_(AzimuthShapeOf(geometry.sonar, parameters)),
      transmit_(parameters.beam) {
  for (const std::string& name : material_names) {
    materials_.push_back(parameters.Material(name).gsab);
    const auto mirror = parameters.mirrors.find(name);
    loss_db_.push_back(mirror == parameters.mirrors.end() ? std::numeric_limits<double>::infinity()
                                                          : mirror->second.loss_db);
  }
}

// What a leg does to the power of an echo that goes out or comes back by it.
double GhostPower::OfLeg(const GhostLeg& leg) const {
  const double spreading_m = leg.spreading_m;
  double loss_db = TransmissionLossDb(spreading_m, absorption_db_per_m_) +
                   absorption_db_per_m_ * (leg.length_m - spreading_m);
  for (const std::uint16_t mirror : leg.mirror) {
    if (mirror != kNoMirror) loss_db += loss_db_[mirror];
  }
  return PowerFromDb(-loss_db) * std::sqrt(elevation_.Power(leg.elevation_rad));
}

double GhostPower::OneWay(const GhostEcho& echo) const {
  const GsabParameters<double>& gsab = materials_[echo.material];
  const double incidence_deg = DegFromRad(double{echo.leg.incidence_rad});
  const double of_leg = OfLeg(echo.leg);
  const double area_m2 =
      PatchAreaM2(echo.leg.spreading_m, echo.solid_angle_sr, std::cos(echo.leg.incidence_rad));
  if (!echo.both_ways) return level_ * of_leg * of_leg * GsabPower(gsab, incidence_deg) * area_m2;
  return level_ * of_leg * OfLeg(echo.other) * area_m2 *
         GsabBetweenPower(gsab, incidence_deg, DegFromRad(double{echo.other.incidence_rad}),
                          DegFromRad(double{echo.tilt_rad}));
}

double GhostPower::InCommon(double azimuth_rad, double middle_rad) const {
  const double power = azimuth_.Power(azimuth_rad, middle_rad);
  return power < kLeastInCommon ? 0.0 : power;
}

void AddGhosts(const GhostList& ghosts, const AcousticGeometry& geometry, const ParameterSet& parameters,
               ScatterMap& scatter) {
  const GhostPower power(ghosts.material_names, geometry, parameters);
  const PolarAxes& axes = geometry.sonar.axes;
  const double step_m = axes.range_bin_m() / scatter.range_steps;
  // What costs time on all cores; sums in the order of the list, the same on any number of threads.
  std::vector<double> one_way(ghosts.echoes.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, one_way.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) one_way[i] = power.OneWay(ghosts.echoes[i]);
  });
  for (std::size_t i = 0; i < one_way.size(); ++i) {
    power.ForEachArrival(ghosts.echoes[i], one_way[i], [&](const GhostArrival& arrival) {
      const auto column = Place(scatter.column_azimuth_rad, arrival.azimuth_rad);
      if (!column) return;
      const double position = (arrival.range_m - axes.range_min_m) / step_m - 0.5;
      const int row = static_cast<int>(std::floor(position));
      const double along = position - row;
      for (const int down : {0, 1}) {
        if (row + down < 0 || row + down >= scatter.power.rows()) continue;
        const double of_row = arrival.power * (down == 0 ? 1.0 - along : along);
        scatter.power(row + down, column->index) += (1.0 - column->fraction) * of_row;
        scatter.power(row + down, column->index + 1) += column->fraction * of_row;
      }
    });
  }
}

}  // namespace sonarcal
