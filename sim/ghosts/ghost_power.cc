#include "sim/ghosts/ghost_power.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/types/units.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/gsab.h"
#include "sim/physics/patch.h"
#include "sim/physics/propagation.h"

namespace sonarcal::sim {
namespace {

constexpr double kLeastInCommon = 1e-6;

}  // namespace

GhostPower::GhostPower(const std::vector<std::string>& material_names, const AcousticGeometry& geometry,
                       const ParameterSet& parameters)
    : level_(PowerFromDb(parameters.source_level_db + parameters.receiver.gain_db)),
      absorption_db_per_m_(geometry.absorption_db_per_m),
      elevation_(ElevationResponseOf(geometry.sonar, parameters.beam)),
      azimuth_(AzimuthShapeOf(geometry.sonar, parameters)),
      transmit_(parameters.beam) {
  for (const std::string& name : material_names) {
    materials_.push_back(parameters.Material(name).gsab);
    const auto mirror = parameters.mirrors.find(name);
    loss_db_.push_back(mirror == parameters.mirrors.end() ? std::numeric_limits<double>::infinity()
                                                          : mirror->second.loss_db);
  }
}

// Factor of one leg on the power of an echo, without reflections.
double GhostPower::OfLeg(const GhostLeg& leg) const {
  const double spreading_m = leg.spreading_m;
  const double loss_db = TransmissionLossDb(spreading_m, absorption_db_per_m_) +
                         absorption_db_per_m_ * (leg.length_m - spreading_m);
  return PowerFromDb(-loss_db) * std::sqrt(elevation_.Power(leg.elevation_rad));
}

double GhostPower::MirrorLossDb(const GhostLeg& leg) const {
  double loss_db = 0.0;
  for (const std::uint16_t mirror : leg.mirror) {
    if (mirror != kNoMirror) loss_db += loss_db_[mirror];
  }
  return loss_db;
}

double GhostPower::UnitOneWay(const GhostEcho& echo) const {
  const double area_m2 =
      PatchAreaM2(echo.leg.spreading_m, echo.solid_angle_sr, std::cos(echo.leg.incidence_rad));
  const double of_leg = OfLeg(echo.leg);
  return of_leg * (echo.both_ways ? OfLeg(echo.other) : of_leg) * area_m2;
}

double GhostPower::OneWay(const GhostEcho& echo) const {
  const GsabParameters<double>& gsab = materials_[echo.material];
  const double incidence_deg = DegFromRad(double{echo.leg.incidence_rad});
  const double scattered =
      echo.both_ways ? GsabBetweenPower(gsab, incidence_deg, DegFromRad(double{echo.other.incidence_rad}),
                                        DegFromRad(double{echo.tilt_rad}))
                     : GsabPower(gsab, incidence_deg);
  return level_ * PowerFromDb(-MirrorLossDb(echo.leg) - MirrorLossDb(echo.other)) * scattered *
         UnitOneWay(echo);
}

double GhostPower::InCommon(double azimuth_rad, double middle_rad) const {
  const double power = azimuth_.Power(azimuth_rad, middle_rad);
  return power < kLeastInCommon ? 0.0 : power;
}

std::optional<ArrivalGrid::Between> ArrivalGrid::Place(double azimuth_rad) const {
  const int last = static_cast<int>(columns_.size()) - 1;
  if (last < 1) return std::nullopt;
  const auto above = std::upper_bound(columns_.begin() + 1, columns_.end() - 1, azimuth_rad);
  const int index = static_cast<int>(above - columns_.begin()) - 1;
  const double fraction = (azimuth_rad - columns_[index]) / (*above - columns_[index]);
  // Tolerance for rounding to single precision.
  if (fraction < -0.5001 || fraction > 1.5001) return std::nullopt;
  return Between{index, std::clamp(fraction, 0.0, 1.0)};
}

void AddGhosts(const GhostList& ghosts, const AcousticGeometry& geometry, const ParameterSet& parameters,
               ScatterMap& scatter) {
  if (ghosts.echoes.empty()) return;
  const GhostPower power(ghosts.material_names, geometry, parameters);
  const PolarAxes& axes = geometry.sonar.axes;
  const ArrivalGrid grid(scatter.column_azimuth_rad, axes.range_min_m,
                         axes.range_bin_m() / scatter.range_steps, scatter.power.rows());
  // Computes powers on all cores, then sums in the order of the list, so the result does not depend on the
  // number of threads.
  std::vector<double> one_way(ghosts.echoes.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, one_way.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) one_way[i] = power.OneWay(ghosts.echoes[i]);
  });
  for (std::size_t i = 0; i < one_way.size(); ++i) {
    power.ForEachArrival(ghosts.echoes[i], one_way[i], [&](const GhostArrival& arrival) {
      grid.ForEachCell(arrival,
                       [&](int row, int column, double of_cell) { scatter.power(row, column) += of_cell; });
    });
  }
}

}  // namespace sonarcal::sim
