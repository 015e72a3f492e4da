#include "sim/ghosts/ghost_power.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/types/units.h"
#include "sim/ghosts/ghost_math.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/fine_rows.h"
#include "sim/physics/gsab.h"
#include "sim/physics/patch.h"
#include "sim/physics/propagation.h"
#include "sim/rays/row_math/sums.h"

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
  std::int32_t row;
  std::int32_t column;
  float nearer;
  float further;  // of the next row
};

constexpr int kBandCols = row_math::kBlockCols;
constexpr std::size_t kChunk = 2048;  // echoes
constexpr std::size_t kManyEchoes = 50'000;

// Shares of a list, by bands of kBandCols columns. Computed on all cores; ForEach visits a band in the order
// of the list, so sums do not depend on the number of threads.
class BandShares {
 public:
  BandShares(const GhostList& ghosts, const GhostPower& power, const ArrivalGrid& grid, int cols)
      : bands_((cols + kBandCols - 1) / kBandCols), chunks_((ghosts.echoes.size() + kChunk - 1) / kChunk) {
    tbb::enumerable_thread_specific<std::vector<ColumnShare>> locals;
    tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t chunk) {
      std::vector<ColumnShare>& shares = locals.local();
      shares.clear();
      const std::size_t end = std::min((chunk + 1) * kChunk, ghosts.echoes.size());
      const std::span echoes(&ghosts.echoes[chunk * kChunk], end - chunk * kChunk);
      const std::vector<double> powers = power.OneWays(echoes);
      for (std::size_t i = 0; i < echoes.size(); ++i) {
        power.ForEachArrival(echoes[i], powers[i], [&](const GhostArrival& arrival) {
          grid.ForEachColumn(arrival, [&](int row, int column, double nearer, double further) {
            shares.push_back({row, column, static_cast<float>(nearer), static_cast<float>(further)});
          });
        });
      }
      Sort(shares, chunks_[chunk]);
    });
  }

  int bands() const { return bands_; }

  template <typename Take>
  void ForEach(int band, const Take& take) const {
    for (const Chunk& chunk : chunks_) {
      for (std::size_t i = chunk.start[band]; i < chunk.start[band + 1]; ++i) take(chunk.shares[i]);
    }
  }

 private:
  struct Chunk {
    std::vector<ColumnShare> shares;
    std::vector<std::size_t> start;  // per band; bands + 1 values
  };

  // Counting sort by band.
  void Sort(const std::vector<ColumnShare>& shares, Chunk& chunk) const {
    chunk.start.assign(bands_ + 1, 0);
    for (const ColumnShare& share : shares) ++chunk.start[share.column / kBandCols + 1];
    for (int band = 0; band < bands_; ++band) chunk.start[band + 1] += chunk.start[band];
    std::vector<std::size_t> next = chunk.start;
    chunk.shares.resize(shares.size());
    for (const ColumnShare& share : shares) chunk.shares[next[share.column / kBandCols]++] = share;
  }

  int bands_;
  std::vector<Chunk> chunks_;
};

}  // namespace

GhostPower::GhostPower(const std::vector<std::string>& material_names, const AcousticGeometry& geometry,
                       const ParameterSet& parameters)
    : model_(geometry, parameters, material_names),
      azimuth_(AzimuthShapeOf(geometry.sonar, parameters)),
      transmit_(parameters.beam),
      elevation_width_deg_(ElevationWidthDeg(geometry.sonar, parameters.beam)) {
  negligible_beyond_rad_ = BeyondRad(azimuth_);
  const auto single = [](double value) { return static_cast<float>(value); };
  for (const GsabParameters<double>& curve : model_.materials()) {
    curves_.push_back({.a = single(curve.a),
                       .b_deg = single(curve.b_deg),
                       .c = single(curve.c),
                       .d = single(curve.d),
                       .e = single(curve.e),
                       .f_deg = single(curve.f_deg)});
  }
  for (const std::string& name : material_names) {
    const auto mirror = parameters.mirrors.find(name);
    reflected_.push_back(mirror == parameters.mirrors.end() ? 0.0 : PowerFromDb(-mirror->second.loss_db));
  }
}

void GhostPower::TabulateElevations() {
  constexpr double kStepsPerWidth = 300.0;
  const int steps = static_cast<int>(
      std::clamp(kStepsPerWidth * 180.0 / std::max(elevation_width_deg_, 1e-3), 4096.0, 65536.0));
  elevation_table_.resize(steps + 2);
  tbb::parallel_for(tbb::blocked_range<int>(0, steps + 2, 512), [&](const tbb::blocked_range<int>& range) {
    for (int i = range.begin(); i != range.end(); ++i)
      elevation_table_[i] = model_.elevation().Power(kPi * (static_cast<double>(i) / steps - 0.5));
  });
}

double GhostPower::ElevationPower(double elevation_rad) const {
  if (elevation_table_.empty()) return model_.elevation().Power(elevation_rad);
  const auto steps = static_cast<double>(elevation_table_.size() - 2);
  const double position = std::clamp(elevation_rad / kPi + 0.5, 0.0, 1.0) * steps;
  const auto i = static_cast<std::size_t>(position);
  return elevation_table_[i] +
         (position - static_cast<double>(i)) * (elevation_table_[i + 1] - elevation_table_[i]);
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
  const double elevation_power = ElevationPower(echo.leg.elevation_rad);
  EchoPath path{
      .loss_db = 2.0 * loss_db,
      .elevation_power = elevation_power,
      .area_m2 = PatchAreaM2(echo.leg.spreading_m, echo.solid_angle_sr, std::cos(echo.leg.incidence_rad))};
  if (echo.both_ways) {
    path.loss_db = loss_db + LossDb(echo.other);
    path.elevation_power = std::sqrt(elevation_power * ElevationPower(echo.other.elevation_rad));
  }
  return path;
}

double GhostPower::MirrorFactor(const GhostLeg& leg) const {
  double factor = 1.0;
  for (const std::uint16_t mirror : leg.mirror) {
    if (mirror != kNoMirror) factor *= reflected_[mirror];
  }
  return factor;
}

double GhostPower::UnitOneWay(const GhostEcho& echo) const {
  return EchoPowerModel::UnitPower(PathOf(echo));
}

double GhostPower::OneWay(const GhostEcho& echo) const {
  const GsabParameters<float>& gsab = curves_[echo.material];
  const double incidence_deg = DegFromRad(double{echo.leg.incidence_rad});
  const float scattered =
      echo.both_ways ? GsabBetweenPower(gsab, incidence_deg, DegFromRad(double{echo.other.incidence_rad}),
                                        DegFromRad(double{echo.tilt_rad}))
                     : GsabPower(gsab, incidence_deg);
  return model_.Power(PathOf(echo), scattered) * MirrorFactor(echo.leg) * MirrorFactor(echo.other);
}

std::vector<double> GhostPower::OneWays(std::span<const GhostEcho> echoes) const {
  using ghost_math::Echoes;
  const double level = model_.level();
  const auto loss_per_m = static_cast<float>(model_.absorption_db_per_m() * kNeperPerDb);
  const auto per_square = [](float width_deg) {
    const double width_rad = RadFromDeg(double{width_deg});
    return static_cast<float>(0.5 / (width_rad * width_rad));
  };
  std::vector<float> per_b;  // per material
  std::vector<float> per_f;
  for (const GsabParameters<float>& curve : curves_) {
    per_b.push_back(per_square(curve.b_deg));
    per_f.push_back(per_square(curve.f_deg));
  }
  std::vector<double> powers(echoes.size());
  Echoes some;
  float power[Echoes::kMax];
  for (std::size_t first = 0; first < echoes.size(); first += Echoes::kMax) {
    const int count = static_cast<int>(std::min<std::size_t>(Echoes::kMax, echoes.size() - first));
    for (int i = 0; i < count; ++i) {
      const GhostEcho& echo = echoes[first + i];
      const GsabParameters<float>& curve = curves_[echo.material];
      some.weight[i] =
          static_cast<float>(echo.solid_angle_sr * MirrorFactor(echo.leg) * MirrorFactor(echo.other));
      some.elevation_power[i] = static_cast<float>(ElevationPower(echo.leg.elevation_rad) *
                                                   ElevationPower(echo.other.elevation_rad));
      some.length_m[i] = echo.leg.length_m + echo.other.length_m;
      some.back_spreading_m[i] = echo.other.spreading_m;
      some.incidence_rad[i] = echo.leg.incidence_rad;
      some.other_incidence_rad[i] = echo.other.incidence_rad;
      some.tilt_rad[i] = echo.tilt_rad;
      some.a[i] = curve.a;
      some.per_b[i] = per_b[echo.material];
      some.c[i] = curve.c;
      some.half_d[i] = 0.5F * curve.d;
      some.e[i] = curve.e;
      some.per_f[i] = per_f[echo.material];
    }
    ghost_math::Powers(some, loss_per_m, count, power);
    for (int i = 0; i < count; ++i) powers[first + i] = level * power[i];
  }
  return powers;
}

double GhostPower::InCommon(float azimuth_rad, float middle_rad) const {
  const float apart_rad = azimuth_rad - middle_rad;
  if (std::abs(apart_rad) > negligible_beyond_rad_) return 0.0;
  // A thousandth of the beam's width loses 3e-6. Most legs of a floor or a surface arrive from one azimuth.
  if (std::abs(apart_rad) < 1e-3 * azimuth_.shape().width_rad) return 1.0;
  if (azimuth_.shape().pattern == AzimuthPattern::kAperture) {
    // sin a - sin m by one sine and one cosine.
    const float mean_rad = 0.5F * (azimuth_rad + middle_rad);
    const double field = azimuth_.ApertureFieldAt(2.0F * std::cos(mean_rad) * std::sin(0.5F * apart_rad));
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
  GhostPower power(ghosts.material_names, geometry, parameters);
  if (ghosts.echoes.size() > kManyEchoes) power.TabulateElevations();
  const ArrivalGrid grid(scatter.column_azimuth_rad, scatter.RowsOf(geometry.sonar.axes));
  const BandShares shares(ghosts, power, grid, scatter.power.cols());
  tbb::parallel_for(0, shares.bands(), [&](int band) {
    shares.ForEach(band, [&](const ColumnShare& share) {
      scatter.power(share.row, share.column) += share.nearer;
      if (share.further != 0.0F) scatter.power(share.row + 1, share.column) += share.further;
    });
  });
}

void AddGhosts(const GhostList& ghosts, const AcousticGeometry& geometry, const ParameterSet& parameters,
               PulsedMap& pulsed) {
  if (ghosts.echoes.empty()) return;
  const PolarAxes& axes = geometry.sonar.axes;
  const int steps = RangeStepsFor(geometry.sonar, parameters);
  const FineRows rows(axes, steps, PulseLengthM(geometry.sonar, parameters));
  const ResponseWindow pulse = PulseWindow(geometry.sonar, parameters, steps, ResponseOf::kPower);
  const std::vector<float> weight(pulse.weight.begin(), pulse.weight.end());
  GhostPower power(ghosts.material_names, geometry, parameters);
  if (ghosts.echoes.size() > kManyEchoes) power.TabulateElevations();
  const int cols = pulsed.power.cols();
  const BandShares shares(ghosts, power, ArrivalGrid(pulsed.column_azimuth_rad, rows), cols);
  tbb::parallel_for(0, shares.bands(), [&](int band) {
    // One row more takes the further share of the last one.
    std::vector<float> fine(static_cast<std::size_t>(rows.count + 1) * kBandCols, 0.0F);
    const int first_col = band * kBandCols;
    shares.ForEach(band, [&](const ColumnShare& share) {
      float* cell = &fine[static_cast<std::size_t>(share.row) * kBandCols + (share.column - first_col)];
      cell[0] += share.nearer;
      cell[kBandCols] += share.further;
    });
    for (int bin = 0; bin < axes.range_bins; ++bin) {
      const int first_row = bin * steps + pulse.first;
      const int begin = std::max(first_row, 0);
      const int end = std::min(first_row + static_cast<int>(weight.size()), rows.count);
      if (begin >= end) continue;
      std::array<float, kBandCols> sums = {};
      row_math::WeighRows(&weight[begin - first_row], &fine[static_cast<std::size_t>(begin) * kBandCols],
                          end - begin, sums.data());
      for (int i = 0; i < std::min(kBandCols, cols - first_col); ++i)
        pulsed.power(bin, first_col + i) += sums[i];
    }
  });
}

}  // namespace sonarcal::sim
