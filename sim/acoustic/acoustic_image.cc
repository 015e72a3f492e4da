#include "sim/acoustic/acoustic_image.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "core/math/random.h"
#include "sim/acoustic/azimuth_filter.h"
#include "sim/acoustic/beam_noise.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/display.h"
#include "sim/physics/receiver.h"
#include "sim/physics/speckle.h"
#include "sim/rays/row_math/sums.h"

namespace sonarcal::sim {
namespace {

// Filters `fine` (fine rows x columns) along range, of power or of a part of the field, to bins x columns.
Grid<double> AlongRange(const Grid<double>& fine, int range_bins, int range_steps,
                        const ResponseWindow& pulse) {
  constexpr int kBins = 8;
  constexpr int kCols = 256;  // of that many bins and columns the fine rows stay in the cache
  std::vector<char> silent(fine.rows());
  for (int row = 0; row < fine.rows(); ++row) {
    const auto values = fine.row(row);
    silent[row] =
        std::all_of(values.begin(), values.end(), [](double value) { return value == 0.0; }) ? 1 : 0;
  }
  Grid<double> out(range_bins, fine.cols());
  tbb::parallel_for(tbb::blocked_range<int>(0, range_bins, kBins), [&](const tbb::blocked_range<int>& bins) {
    for (int col = 0; col < fine.cols(); col += kCols) {
      const int cols = std::min(kCols, fine.cols() - col);
      for (int bin = bins.begin(); bin != bins.end(); ++bin) {
        for (std::size_t i = 0; i < pulse.weight.size(); ++i) {
          const int row = bin * range_steps + pulse.first + static_cast<int>(i);
          if (row < 0 || row >= fine.rows() || silent[row] != 0) continue;
          row_math::AddScaled(pulse.weight[i], &fine(row, col), cols, &out(bin, col));
        }
      }
    }
  });
  return out;
}

// The pulse comes first because it leaves fewer rows for the azimuth response, which may be as wide as the
// fan.
class FieldResponses {
 public:
  FieldResponses(const AcousticGeometry& geometry, const ParameterSet& parameters, const ScatterMap& scatter)
      : range_bins_(geometry.sonar.axes.range_bins),
        range_steps_(scatter.range_steps),
        pulse_(PulseWindow(geometry.sonar, parameters, scatter.range_steps, ResponseOf::kField)),
        azimuth_(AzimuthWindows(geometry.sonar, parameters, scatter.column_azimuth_rad, ResponseOf::kField)) {
  }

  // Field received, bins x beams, of the real or of the imaginary part of a field, fine rows x columns.
  Grid<double> Received(const Grid<double>& part) const {
    return azimuth_.Filter(AlongRange(part, range_bins_, range_steps_, pulse_));
  }

 private:
  int range_bins_;
  int range_steps_;
  ResponseWindow pulse_;
  AzimuthFilter<double> azimuth_;
};

// Random number of each patch of a map, and the phase that its path adds.
//
// A patch at a range and azimuth of the sonar lies in some cell of the axes for which the scatterers are
// drawn. It has the random number of that cell. Its phase differs by that of the difference in range.
class PatchesInWorld {
 public:
  PatchesInWorld(const ScatterMap& scatter, const SonarModel& sonar, const Pose& drawn_from_sonar)
      : rows_(scatter.RowsOf(sonar.axes)),
        azimuth_rad_(scatter.column_azimuth_rad),
        twice_wavenumber_(2.0 * Wavenumber(sonar)),
        drawn_from_sonar_(drawn_from_sonar) {}

  struct Patch {
    std::uint64_t index = 0;
    double phase_rad = 0.0;
  };
  Patch At(int row, int col) const {
    const double range_m = rows_.first_m + row / rows_.per_m;
    const double azimuth_rad = azimuth_rad_[col];
    const Eigen::Vector3d at_m = drawn_from_sonar_ * Eigen::Vector3d(range_m * std::sin(azimuth_rad),
                                                                     range_m * std::cos(azimuth_rad), 0.0);
    const double drawn_range_m = at_m.norm();
    const auto drawn_row = std::llround((drawn_range_m - rows_.first_m) * rows_.per_m);
    return {.index = IndexOf(drawn_row, ColumnAt(std::atan2(at_m.x(), at_m.y()))),
            .phase_rad = twice_wavenumber_ * (drawn_range_m - range_m)};
  }

 private:
  // Nearest column. Columns continue beyond the fan with the width of its mean column.
  std::int64_t ColumnAt(double azimuth_rad) const {
    const auto count = static_cast<std::int64_t>(azimuth_rad_.size());
    if (count < 2) return 0;
    const double width_rad = (azimuth_rad_.back() - azimuth_rad_.front()) / static_cast<double>(count - 1);
    if (azimuth_rad <= azimuth_rad_.front())
      return std::llround((azimuth_rad - azimuth_rad_.front()) / width_rad);
    if (azimuth_rad >= azimuth_rad_.back())
      return count - 1 + std::llround((azimuth_rad - azimuth_rad_.back()) / width_rad);
    const auto above = std::upper_bound(azimuth_rad_.begin(), azimuth_rad_.end(), azimuth_rad);
    const std::int64_t right = above - azimuth_rad_.begin();
    return azimuth_rad - *(above - 1) < *above - azimuth_rad ? right - 1 : right;
  }

  // Within the map: as without motion. Beyond it: indices of their own.
  std::uint64_t IndexOf(std::int64_t row, std::int64_t col) const {
    const auto cols = static_cast<std::int64_t>(azimuth_rad_.size());
    if (row >= 0 && row < rows_.count && col >= 0 && col < cols)
      return static_cast<std::uint64_t>(row * cols + col);
    constexpr int kColumnBits = 24;
    constexpr std::int64_t kMiddle = std::int64_t{1} << (kColumnBits - 1);
    constexpr std::uint64_t kBeyond = std::uint64_t{1} << 60;
    return kBeyond + (static_cast<std::uint64_t>(row + kMiddle) << kColumnBits) +
           static_cast<std::uint64_t>(col + kMiddle);
  }

  FineRows rows_;
  const std::vector<double>& azimuth_rad_;
  double twice_wavenumber_;
  Pose drawn_from_sonar_;
};

// Field of one look: each patch scatters with a random phase. `patches`: null if the scatterers are drawn
// for the sonar itself.
struct ScatteredField {
  ScatteredField(const ScatterMap& scatter, const PatchesInWorld* patches, const CounterRandom& random)
      : real(scatter.power.rows(), scatter.power.cols()), imaginary(real.rows(), real.cols()) {
    tbb::parallel_for(tbb::blocked_range<int>(0, real.rows(), 16), [&](const tbb::blocked_range<int>& rows) {
      for (int row = rows.begin(); row != rows.end(); ++row) {
        for (int col = 0; col < real.cols(); ++col) {
          const double power = scatter.power(row, col);
          if (power == 0.0) continue;
          const double amplitude = std::sqrt(0.5 * power);
          if (patches != nullptr) {
            const auto [index, phase_rad] = patches->At(row, col);
            const auto [re, im] = random.Normal2(index);
            const std::complex<double> field =
                std::polar(amplitude, phase_rad) * std::complex<double>(re, im);
            real(row, col) = field.real();
            imaginary(row, col) = field.imag();
            continue;
          }
          const auto [re, im] = random.Normal2(static_cast<std::size_t>(row) * real.cols() + col);
          real(row, col) = amplitude * re;
          imaginary(row, col) = amplitude * im;
        }
      }
    });
  }

  Grid<double> real;
  Grid<double> imaginary;
};

// Image of `value` of each power (0..1 of full scale, clipped).
template <typename Value>
PolarImage Displayed(const Grid<double>& power, const PolarAxes& axes, const ParameterSet& parameters,
                     double full_scale, const Value& value) {
  PolarImage image{axes, GreyScale(parameters.display, full_scale), Grid<float>(power.rows(), power.cols())};
  tbb::parallel_for(tbb::blocked_range<int>(0, power.rows(), 32), [&](const tbb::blocked_range<int>& rows) {
    for (int row = rows.begin(); row != rows.end(); ++row) {
      std::transform(power.row(row).begin(), power.row(row).end(), image.value.row(row).begin(),
                     [&](double of_pixel) { return static_cast<float>(full_scale * value(of_pixel)); });
    }
  });
  return image;
}

// Display law, clipped to 0..1.
auto AsShown(const DisplayParameters<double>& display) {
  return [display](double power) { return std::clamp(DisplayValue(display, power), 0.0, 1.0); };
}

}  // namespace

std::vector<double> GainByBin(const AcousticGeometry& geometry, const ParameterSet& parameters) {
  std::vector<double> gain;
  for (int bin = 0; bin < geometry.sonar.axes.range_bins; ++bin) {
    gain.push_back(
        PowerFromDb(TimeVariedGainDb(parameters.receiver.time_varied_gain,
                                     geometry.sonar.axes.range_centre_m(bin), geometry.absorption_db_per_m)));
  }
  return gain;
}

Grid<double> NoiseFloorPower(const AcousticGeometry& geometry, const ParameterSet& parameters) {
  const PolarAxes& axes = geometry.sonar.axes;
  const ReceiverNoise floor(parameters.receiver, axes, geometry.absorption_db_per_m);
  Grid<double> noise(axes.range_bins, axes.beam_count());
  for (int bin = 0; bin < noise.rows(); ++bin) {
    for (int beam = 0; beam < noise.cols(); ++beam) noise(bin, beam) = floor.Power(bin, beam);
  }
  return noise;
}

std::vector<double> ColumnAzimuthsRad(const RayFan& fan) {
  std::vector<double> azimuth_rad;
  for (int col = 0; col < fan.cols(); ++col) azimuth_rad.push_back(fan.AzimuthRad(col));
  return azimuth_rad;
}

ScatterMap EmptyScatterMap(const RayFan& fan, const AcousticGeometry& geometry,
                           const ParameterSet& parameters) {
  return EmptyScatterMap(ColumnAzimuthsRad(fan), geometry, parameters);
}

ScatterMap EmptyScatterMap(std::vector<double> column_azimuth_rad, const AcousticGeometry& geometry,
                           const ParameterSet& parameters) {
  const PolarAxes& axes = geometry.sonar.axes;
  ScatterMap scatter;
  scatter.column_azimuth_rad = std::move(column_azimuth_rad);
  scatter.range_steps = RangeStepsFor(geometry.sonar, parameters);
  scatter.pulse_m = PulseLengthM(geometry.sonar, parameters);
  scatter.power = Grid<double>(axes.range_bins * scatter.range_steps,
                               static_cast<int>(scatter.column_azimuth_rad.size()));
  return scatter;
}

ScatterMap MakeScatterMap(const EchoList& echoes, const RayFan& fan, const AcousticGeometry& geometry,
                          const ParameterSet& parameters) {
  ScatterMap scatter = EmptyScatterMap(fan, geometry, parameters);
  const EchoPowerModel model(geometry, parameters, echoes.material_names);

  // Each power is computed separately on all cores, then summed in the order of the rays, so sums do not
  // depend on the number of threads.
  std::vector<double> powers(echoes.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, echoes.size(), 4096),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      // Neighbouring rays of a row share their elevation.
                      float elevation_rad = std::numeric_limits<float>::quiet_NaN();
                      double elevation_power = 1.0;
                      for (std::size_t echo = range.begin(); echo != range.end(); ++echo) {
                        if (echoes.elevation_rad[echo] != elevation_rad) {
                          elevation_rad = echoes.elevation_rad[echo];
                          elevation_power = model.elevation().Power(elevation_rad);
                        }
                        const double incidence_rad = echoes.incidence_rad[echo];
                        powers[echo] =
                            model.Power(model.StraightBack(echoes.range_m[echo], incidence_rad,
                                                           echoes.solid_angle_sr[echo], elevation_power),
                                        model.Backscatter(echoes.material[echo], incidence_rad));
                      }
                    });
  const FineRows rows = scatter.RowsOf(geometry.sonar.axes);
  for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
    const int row = static_cast<int>(echoes.ray[echo] / echoes.cols);
    const int col = static_cast<int>(echoes.ray[echo] % echoes.cols);
    const double depth_m = PatchDepthM(echoes.range_m[echo], fan.SpreadHeightRad(row, col),
                                       std::cos(double{echoes.incidence_rad[echo]}));
    scatter.Add(rows, echoes.range_m[echo], depth_m, col, powers[echo]);
  }
  return scatter;
}

Grid<double> ThroughPulse(const ScatterMap& scatter, const AcousticGeometry& geometry,
                          const ParameterSet& parameters) {
  return AlongRange(scatter.power, geometry.sonar.axes.range_bins, scatter.range_steps,
                    PulseWindow(geometry.sonar, parameters, scatter.range_steps, ResponseOf::kPower));
}

Grid<double> EchoPowerImage(const ScatterMap& scatter, const AcousticGeometry& geometry,
                            const ParameterSet& parameters) {
  const AzimuthFilter<double> azimuth(
      AzimuthWindows(geometry.sonar, parameters, scatter.column_azimuth_rad, ResponseOf::kPower));
  Grid<double> power = azimuth.Filter(ThroughPulse(scatter, geometry, parameters));
  const std::vector<double> gain = GainByBin(geometry, parameters);
  for (int bin = 0; bin < power.rows(); ++bin) {
    for (double& value : power.row(bin)) value *= gain[bin];
  }
  return power;
}

void AddNoiseFloor(const AcousticGeometry& geometry, const ParameterSet& parameters, Grid<double>& power) {
  const Grid<double> noise = NoiseFloorPower(geometry, parameters);
  std::transform(power.values().begin(), power.values().end(), noise.values().begin(), power.values().begin(),
                 std::plus<>());
}

PolarImage PowerImage(const PolarAxes& axes, const Grid<double>& power) {
  PolarImage image{
      axes,
      {.quantity = Quantity::kPower, .full_scale = 1.0, .db_min = {}, .db_max = {}, .db_span = {}},
      Grid<float>(power.rows(), power.cols())};
  std::transform(power.values().begin(), power.values().end(), image.value.values().begin(),
                 [](double value) { return static_cast<float>(value); });
  return image;
}

PolarImage ExpectedPower(const ScatterMap& scatter, const AcousticGeometry& geometry,
                         const ParameterSet& parameters) {
  Grid<double> power = EchoPowerImage(scatter, geometry, parameters);
  AddNoiseFloor(geometry, parameters, power);
  return PowerImage(geometry.sonar.axes, power);
}

PolarImage ExpectedDisplay(const PolarImage& power, const ParameterSet& parameters, double full_scale) {
  Grid<double> values(power.value.rows(), power.value.cols());
  std::copy(power.value.values().begin(), power.value.values().end(), values.values().begin());
  const MeanDisplayTable mean(parameters.display, parameters.receiver.looks);
  return Displayed(values, power.axes, parameters, full_scale, mean);
}

PolarImage DisplayPower(const PolarImage& power, const ParameterSet& parameters, double full_scale) {
  Grid<double> values(power.value.rows(), power.value.cols());
  std::copy(power.value.values().begin(), power.value.values().end(), values.values().begin());
  return Displayed(values, power.axes, parameters, full_scale, AsShown(parameters.display));
}

PolarImage SampleAcousticImage(const ScatterMap& scatter, const AcousticGeometry& geometry,
                               const ParameterSet& parameters, double full_scale, const DrawSeeds& seeds,
                               const Pose& drawn_from_sonar) {
  using Complex = std::complex<double>;
  CheckLooksToDraw(parameters.receiver.looks);
  const auto [whole_looks, last_weight] = LooksAsWeights(parameters.receiver.looks);
  const FieldResponses responses(geometry, parameters, scatter);
  std::optional<PatchesInWorld> patches;
  if (!IsIdentity(drawn_from_sonar)) patches.emplace(scatter, geometry.sonar, drawn_from_sonar);
  const BeamNoise beam_noise(geometry.sonar, parameters);
  const Grid<double> noise = NoiseFloorPower(geometry, parameters);
  const std::vector<double> gain = GainByBin(geometry, parameters);
  Grid<double> power(geometry.sonar.axes.range_bins, geometry.sonar.axes.beam_count());
  const int looks = whole_looks + (last_weight > 0.0 ? 1 : 0);
  for (int look = 0; look < looks; ++look) {
    const double weight = (look < whole_looks ? 1.0 : last_weight) / (whole_looks + last_weight);
    const CounterRandom scatterers(seeds.scatterers, static_cast<std::uint32_t>(2 * look));
    const CounterRandom receiver(seeds.receiver, static_cast<std::uint32_t>(2 * look + 1));
    const ScatteredField field(scatter, patches ? &*patches : nullptr, scatterers);
    const Grid<double> real = responses.Received(field.real);
    const Grid<double> imaginary = responses.Received(field.imaginary);
    tbb::parallel_for(0, power.rows(), [&](int bin) {
      std::vector<Complex> unit_noise(power.cols());
      beam_noise.Draw(receiver, bin, unit_noise);
      const double amplitude = std::sqrt(gain[bin]);
      for (int beam = 0; beam < power.cols(); ++beam) {
        power(bin, beam) += weight * std::norm(amplitude * Complex(real(bin, beam), imaginary(bin, beam)) +
                                               std::sqrt(noise(bin, beam)) * unit_noise[beam]);
      }
    });
  }
  return Displayed(power, geometry.sonar.axes, parameters, full_scale, AsShown(parameters.display));
}

}  // namespace sonarcal::sim
