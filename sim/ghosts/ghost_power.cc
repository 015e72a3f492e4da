#include "sim/ghosts/ghost_power.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "core/types/units.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/gsab.h"
#include "sim/physics/patch.h"
#include "sim/physics/propagation.h"

namespace sonarcal::sim {
namespace {

constexpr double kMinInCommon = 1e-6;

}  // namespace

GhostPower::GhostPower(const std::vector<std::string>& material_names, const AcousticGeometry& geometry,
                       const ParameterSet& parameters)
    : model_(geometry, parameters, material_names),
      azimuth_(AzimuthShapeOf(geometry.sonar, parameters)),
      transmit_(parameters.beam) {
  for (const std::string& name : material_names) {
    const auto mirror = parameters.mirrors.find(name);
    loss_db_.push_back(mirror == parameters.mirrors.end() ? std::numeric_limits<double>::infinity()
                                                          : mirror->second.loss_db);
  }
}

// Loss of one leg, without reflections.
double GhostPower::LossDb(const GhostLeg& leg) const {
  const double spreading_m = leg.spreading_m;
  return TransmissionLossDb(spreading_m, model_.absorption_db_per_m()) +
         model_.absorption_db_per_m() * (leg.length_m - spreading_m);
}

// Path out along one leg and back along the other, without reflections.
EchoPath GhostPower::PathOf(const GhostEcho& echo) const {
  const double loss_db = LossDb(echo.leg);
  const double elevation_power = model_.elevation().Power(echo.leg.elevation_rad);
  EchoPath path{
      .loss_db = 2.0 * loss_db,
      .elevation_power = elevation_power,
      .area_m2 = PatchAreaM2(echo.leg.spreading_m, echo.solid_angle_sr, std::cos(echo.leg.incidence_rad))};
  if (echo.both_ways) {
    path.loss_db = loss_db + LossDb(echo.other);
    path.elevation_power = std::sqrt(elevation_power * model_.elevation().Power(echo.other.elevation_rad));
  }
  return path;
}

double GhostPower::MirrorLossDb(const GhostLeg& leg) const {
  double loss_db = 0.0;
  for (const std::uint16_t mirror : leg.mirror) {
    if (mirror != kNoMirror) loss_db += loss_db_[mirror];
  }
  return loss_db;
}

double GhostPower::UnitOneWay(const GhostEcho& echo) const {
  return EchoPowerModel::UnitPower(PathOf(echo));
}

double GhostPower::OneWay(const GhostEcho& echo) const {
  const GsabParameters<double>& gsab = model_.materials()[echo.material];
  const double incidence_deg = DegFromRad(double{echo.leg.incidence_rad});
  const double scattered =
      echo.both_ways ? GsabBetweenPower(gsab, incidence_deg, DegFromRad(double{echo.other.incidence_rad}),
                                        DegFromRad(double{echo.tilt_rad}))
                     : GsabPower(gsab, incidence_deg);
  EchoPath path = PathOf(echo);
  path.loss_db += MirrorLossDb(echo.leg) + MirrorLossDb(echo.other);
  return model_.Power(path, scattered);
}

double GhostPower::InCommon(double azimuth_rad, double middle_rad) const {
  const double power = azimuth_.Power(azimuth_rad, middle_rad);
  return power < kMinInCommon ? 0.0 : power;
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
  const ArrivalGrid grid(scatter.column_azimuth_rad, scatter.RowsOf(geometry.sonar.axes));
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

void AddGhosts(const GhostList& ghosts, const AcousticGeometry& geometry, const ParameterSet& parameters,
               PulsedMap& pulsed) {
  if (ghosts.echoes.empty()) return;
  ScatterMap scatter = EmptyScatterMap(pulsed.column_azimuth_rad, geometry, parameters);
  AddGhosts(ghosts, geometry, parameters, scatter);
  const PulsedMap of_ghosts = ThroughPulse(scatter, geometry, parameters);
  std::transform(pulsed.power.values().begin(), pulsed.power.values().end(), of_ghosts.power.values().begin(),
                 pulsed.power.values().begin(), std::plus<>());
}

}  // namespace sonarcal::sim
