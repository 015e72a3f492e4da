#include "sim/ghosts/ghost_power.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
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

// Difference of two azimuths, at least, at which the response at one to an echo at the other is below
// kMinInCommon, for any azimuths of a sonar's front.
double BeyondRad(const AzimuthResponse<double>& response) {
  if (response.shape().pattern == AzimuthPattern::kTable) return std::numeric_limits<double>::infinity();
  // An aperture's beam is wider off broadside: at most from 90 degrees to where its side lobes end.
  const double at_broadside = AzimuthReachRad(response, 0.0, DbFromPower(kMinInCommon)).second;
  if (response.shape().pattern == AzimuthPattern::kGaussian) return at_broadside;
  const auto [left_rad, right_rad] = AzimuthReachRad(response, 0.5 * kPi, DbFromPower(kMinInCommon));
  return std::max(at_broadside, right_rad - left_rad);
}

// Shares of an arrival for two rows of one column.
struct ColumnShare {
  std::uint32_t row;
  std::uint32_t column;
  double power[2];
};

constexpr int kBands = 8;            // of columns, which are summed at the same time
constexpr std::size_t kChunk = 4096;  // echoes

}  // namespace

GhostPower::GhostPower(const std::vector<std::string>& material_names, const AcousticGeometry& geometry,
                       const ParameterSet& parameters)
    : model_(geometry, parameters, material_names),
      azimuth_(AzimuthShapeOf(geometry.sonar, parameters)),
      transmit_(parameters.beam) {
  negligible_beyond_rad_ = BeyondRad(azimuth_);
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
  const double apart_rad = azimuth_rad - middle_rad;
  if (std::abs(apart_rad) > negligible_beyond_rad_) return 0.0;
  if (azimuth_.shape().pattern == AzimuthPattern::kAperture) {
    // sin a - sin m by one sine and one cosine. Most legs of a floor or a surface arrive from one azimuth.
    const double mean_rad = 0.5 * (azimuth_rad + middle_rad);
    const double field =
        azimuth_.ApertureFieldAt(2.0 * std::cos(mean_rad) * std::sin(0.5 * apart_rad));
    return field * field < kMinInCommon ? 0.0 : field * field;
  }
  const double power = azimuth_.Power(azimuth_rad, middle_rad);
  return power < kMinInCommon ? 0.0 : power;
}

std::optional<ArrivalGrid::Between> ArrivalGrid::Place(double azimuth_rad) const {
  const int last = static_cast<int>(columns_.size()) - 1;
  if (last < 1) return std::nullopt;
  // Columns are nearly even, so the guess is at most a few columns off.
  const double guess = (azimuth_rad - columns_.front()) / (columns_.back() - columns_.front()) * last;
  int index = static_cast<int>(std::clamp(guess, 0.0, last - 1.0));
  while (index > 0 && azimuth_rad < columns_[index]) --index;
  while (index < last - 1 && azimuth_rad >= columns_[index + 1]) ++index;
  const double fraction = (azimuth_rad - columns_[index]) / (columns_[index + 1] - columns_[index]);
  // Tolerance for rounding to single precision.
  if (fraction < -0.5001 || fraction > 1.5001) return std::nullopt;
  return Between{index, std::clamp(fraction, 0.0, 1.0)};
}

void AddGhosts(const GhostList& ghosts, const AcousticGeometry& geometry, const ParameterSet& parameters,
               ScatterMap& scatter) {
  if (ghosts.echoes.empty()) return;
  const GhostPower power(ghosts.material_names, geometry, parameters);
  const ArrivalGrid grid(scatter.column_azimuth_rad, scatter.RowsOf(geometry.sonar.axes));
  const int cols = scatter.power.cols();
  const auto band_of = [cols](int column) { return column * kBands / cols; };
  // Computes the shares of chunks of the list on all cores, then sums each band of columns in the order of the
  // list, so the result does not depend on the number of threads.
  const std::size_t chunks = (ghosts.echoes.size() + kChunk - 1) / kChunk;
  std::vector<std::array<std::vector<ColumnShare>, kBands>> shares(chunks);
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    for (auto& of_band : shares[chunk]) of_band.reserve(kChunk);
    const std::size_t end = std::min((chunk + 1) * kChunk, ghosts.echoes.size());
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      const GhostEcho& echo = ghosts.echoes[i];
      power.ForEachArrival(echo, power.OneWay(echo), [&](const GhostArrival& arrival) {
        grid.ForEachColumn(arrival, [&](int row, int column, double nearer, double further) {
          shares[chunk][band_of(column)].push_back({static_cast<std::uint32_t>(row),
                                                    static_cast<std::uint32_t>(column), {nearer, further}});
        });
      });
    }
  });
  tbb::parallel_for(0, kBands, [&](int band) {
    for (const auto& of_chunk : shares) {
      for (const ColumnShare& share : of_chunk[band]) {
        const int row = static_cast<int>(share.row);
        const int column = static_cast<int>(share.column);
        scatter.power(row, column) += share.power[0];
        if (share.power[1] != 0.0) scatter.power(row + 1, column) += share.power[1];
      }
    }
  });
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
