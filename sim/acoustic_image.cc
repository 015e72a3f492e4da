#include "sim/acoustic_image.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "sim/physics/beam_pattern.h"
#include "sim/physics/gsab.h"
#include "sim/physics/patch.h"
#include "sim/physics/propagation.h"
#include "sim/physics/receiver.h"
#include "sim/physics/speckle.h"
#include "sim/random.h"

namespace sonarcal {
namespace {

constexpr double kReachInWidths = 3.0;  // of the pulse: 2^-36, about -108 dB
constexpr double kGaussianCutDb = -108.0;
constexpr double kSideLobeCutDb = -60.0;

double AzimuthWidthRad(const SonarModel& sonar, const ParameterSet& parameters) {
  const double width_deg = parameters.beam.azimuth_width_deg > 0.0 ? parameters.beam.azimuth_width_deg
                                                                   : sonar.azimuth_beam_width_deg;
  if (!(width_deg > 0.0)) {
    throw DataError("{}: azimuth beam width unknown; give it in the sonar or as beam.azimuth_width_deg",
                    sonar.name);
  }
  return RadFromDeg(width_deg);
}

// Fine rows a range bin: at least 4, and at least 4 a pulse, so that sharing an echo between two of them
// moves no pixel by more than 4.3 % of its peak (the pulse's curvature over a quarter of its length). Pulses
// below a sixteenth of a bin fall between the rows, as they fall between the bins.
constexpr int kFewestRangeSteps = 4;
constexpr int kMostRangeSteps = 64;

int RangeSteps(const SonarModel& sonar, double pulse_m) {
  const double steps = std::ceil(4.0 * sonar.axes.range_bin_m() / pulse_m - 1e-9);
  return static_cast<int>(std::clamp<double>(steps, kFewestRangeSteps, kMostRangeSteps));
}

// Weights of a response at the points of a row of samples, those within reach only.
struct Window {
  int first = 0;
  std::vector<double> weight;
};

// Azimuth response of each beam to the columns of the fan: of field or of power.
std::vector<Window> AzimuthWindows(const std::vector<double>& column_azimuth_rad, const PolarAxes& axes,
                                   const AzimuthShape<double>& shape, bool field) {
  const AzimuthResponse<double> response(shape);
  const double cut_db = shape.pattern == AzimuthPattern::kGaussian ? kGaussianCutDb : kSideLobeCutDb;
  std::vector<Window> windows(axes.beam_count());
  tbb::parallel_for(0, axes.beam_count(), [&](int beam) {
    const double centre = axes.beam_azimuth_rad[beam];
    const auto [lowest, highest] = AzimuthReachRad(response, centre, cut_db);
    const auto first = std::lower_bound(column_azimuth_rad.begin(), column_azimuth_rad.end(), lowest);
    windows[beam].first = static_cast<int>(first - column_azimuth_rad.begin());
    for (auto it = first; it != column_azimuth_rad.end() && *it <= highest; ++it) {
      windows[beam].weight.push_back(field ? response.Field(*it, centre) : response.Power(*it, centre));
    }
  });
  return windows;
}

// Pulse response of a range bin's centre to the fine rows; rows are relative to the bin's first one.
Window PulseWindow(const PolarAxes& axes, int range_steps, double length_m) {
  const double step_m = axes.range_bin_m() / range_steps;
  const int reach = static_cast<int>(std::ceil(kReachInWidths * length_m / step_m)) + range_steps;
  Window window{.first = -reach, .weight = {}};
  for (int row = -reach; row <= reach + range_steps; ++row) {
    const double offset_m = (row + 0.5) * step_m - 0.5 * axes.range_bin_m();
    window.weight.push_back(GaussianResponse(offset_m, length_m));
  }
  return window;
}

// Sums `fine` (fine rows x columns) through both responses to bins x beams, those of field or of power. The
// pulse first: it leaves fewer rows for the azimuth response, which may be as wide as the fan.
template <typename T>
Grid<T> ThroughResponses(const Grid<T>& fine, const AcousticGeometry& geometry,
                         const ParameterSet& parameters, const ScatterMap& scatter, bool field) {
  const PolarAxes& axes = geometry.sonar.axes;
  const std::vector<Window> azimuth =
      AzimuthWindows(scatter.column_azimuth_rad, axes, AzimuthShapeOf(geometry.sonar, parameters), field);
  Window pulse = PulseWindow(axes, scatter.range_steps, PulseLengthM(geometry.sonar, parameters));
  if (field) {
    for (double& weight : pulse.weight) weight = std::sqrt(weight);
  }
  const auto is_silent = [](const auto& row) {
    return std::all_of(row.begin(), row.end(), [](const T& value) { return value == T(0.0); });
  };
  std::vector<char> silent(fine.rows());
  for (int row = 0; row < fine.rows(); ++row) silent[row] = is_silent(fine.row(row)) ? 1 : 0;

  Grid<T> out(axes.range_bins, axes.beam_count());
  tbb::parallel_for(tbb::blocked_range<int>(0, axes.range_bins, 8), [&](const tbb::blocked_range<int>& bins) {
    std::vector<T> in_bin(fine.cols());
    for (int bin = bins.begin(); bin != bins.end(); ++bin) {
      std::fill(in_bin.begin(), in_bin.end(), T(0.0));
      for (std::size_t i = 0; i < pulse.weight.size(); ++i) {
        const int row = bin * scatter.range_steps + pulse.first + static_cast<int>(i);
        if (row < 0 || row >= fine.rows() || silent[row] != 0) continue;
        const auto in = fine.row(row);
        for (int col = 0; col < fine.cols(); ++col) in_bin[col] += pulse.weight[i] * in[col];
      }
      if (is_silent(in_bin)) continue;
      for (int beam = 0; beam < axes.beam_count(); ++beam) {
        T sum(0.0);
        for (std::size_t i = 0; i < azimuth[beam].weight.size(); ++i) {
          sum += azimuth[beam].weight[i] * in_bin[azimuth[beam].first + i];
        }
        out(bin, beam) = sum;
      }
    }
  });
  return out;
}

// Each power as `value` (0..1 of full scale, clipped) shows it.
template <typename Value>
PolarImage Displayed(const Grid<double>& power, const PolarAxes& axes, const ParameterSet& parameters,
                     double full_scale, const Value& value) {
  PolarImage image{axes,
                   {.quantity = Quantity::kGrey,
                    .full_scale = full_scale,
                    .db_min = parameters.display.db_min,
                    .db_max = parameters.display.db_max,
                    .db_span = {}},
                   Grid<float>(power.rows(), power.cols())};
  for (std::size_t i = 0; i < power.size(); ++i) {
    image.value.values()[i] = static_cast<float>(full_scale * value(power.values()[i]));
  }
  return image;
}

// As the display shows a power, clipped.
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

AzimuthShape<double> AzimuthShapeOf(const SonarModel& sonar, const ParameterSet& parameters) {
  const BeamParameters& beam = parameters.beam;
  AzimuthShape<double> shape{.pattern = beam.azimuth_pattern, .taper = beam.azimuth_taper};
  if (beam.azimuth_pattern == AzimuthPattern::kTable) {
    if (beam.azimuth_table_db.size() < 3 || beam.azimuth_table_db.size() % 2 == 0) {
      throw DataError("beam.azimuth_table_db has {} numbers, expected an odd number of them, 3 at least",
                      beam.azimuth_table_db.size());
    }
    const std::vector<double>& centres = sonar.axes.beam_azimuth_rad;
    SONARCAL_CHECK(centres.size() >= 2, "{} beams", centres.size());
    shape.table_db = &beam.azimuth_table_db;
    shape.beam_azimuth_rad = &centres;
    shape.beam_spacing_rad = (centres.back() - centres.front()) / static_cast<double>(centres.size() - 1);
    return shape;
  }
  if (!(beam.azimuth_taper >= 0.0 && beam.azimuth_taper <= 1.0)) {
    throw DataError("beam.azimuth_taper is {}, expected 0 .. 1", beam.azimuth_taper);
  }
  shape.width_rad = AzimuthWidthRad(sonar, parameters);
  return shape;
}

ElevationResponse ElevationResponseOf(const SonarModel& sonar, const ParameterSet& parameters) {
  const BeamParameters& beam = parameters.beam;
  const double width_deg =
      beam.elevation_width_deg > 0.0 ? beam.elevation_width_deg : sonar.elevation_beam_width_deg;
  return {beam.elevation_pattern, RadFromDeg(width_deg), beam.elevation_taper};
}

double PulseLengthM(const SonarModel& sonar, const ParameterSet& parameters) {
  return parameters.pulse.length_m > 0.0 ? parameters.pulse.length_m : sonar.axes.range_bin_m();
}

ScatterMap MakeScatterMap(const EchoList& echoes, const RayFan& fan, const AcousticGeometry& geometry,
                          const ParameterSet& parameters) {
  const PolarAxes& axes = geometry.sonar.axes;
  ScatterMap scatter;
  for (int col = 0; col < fan.cols(); ++col) scatter.column_azimuth_rad.push_back(fan.AzimuthRad(col));
  scatter.range_steps = RangeSteps(geometry.sonar, PulseLengthM(geometry.sonar, parameters));
  scatter.power = Grid<double>(axes.range_bins * scatter.range_steps, fan.cols());
  const double step_m = axes.range_bin_m() / scatter.range_steps;
  const ElevationResponse elevation = ElevationResponseOf(geometry.sonar, parameters);
  std::vector<GsabParameters<double>> materials;
  for (const std::string& name : echoes.material_names) materials.push_back(parameters.Material(name).gsab);

  for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
    const double range_m = echoes.range_m[echo];
    const double level_db = parameters.source_level_db + parameters.receiver.gain_db -
                            2.0 * TransmissionLossDb(range_m, geometry.absorption_db_per_m);
    const double incidence_rad = echoes.incidence_rad[echo];
    const double area_m2 = PatchAreaM2(range_m, echoes.solid_angle_sr[echo], std::cos(incidence_rad));
    const double power = PowerFromDb(level_db) *
                         GsabPower(materials[echoes.material[echo]], DegFromRad(incidence_rad)) * area_m2 *
                         elevation.Power(echoes.elevation_rad[echo]);
    const int col = static_cast<int>(echoes.ray[echo] % echoes.cols);
    // Shared between the two nearest fine rows, so that the image changes smoothly with range.
    const double position = (range_m - axes.range_min_m) / step_m - 0.5;
    const int row = static_cast<int>(std::floor(position));
    const double fraction = position - row;
    if (row >= 0 && row < scatter.power.rows()) scatter.power(row, col) += (1.0 - fraction) * power;
    if (row + 1 >= 0 && row + 1 < scatter.power.rows()) scatter.power(row + 1, col) += fraction * power;
  }
  return scatter;
}

PolarImage ExpectedPower(const ScatterMap& scatter, const AcousticGeometry& geometry,
                         const ParameterSet& parameters) {
  PolarImage image{
      geometry.sonar.axes,
      {.quantity = Quantity::kPower, .full_scale = 1.0, .db_min = {}, .db_max = {}, .db_span = {}},
      Grid<float>(geometry.sonar.axes.range_bins, geometry.sonar.axes.beam_count())};
  const Grid<double> power = ThroughResponses(scatter.power, geometry, parameters, scatter, false);
  const Grid<double> noise = NoiseFloorPower(geometry, parameters);
  const std::vector<double> gain = GainByBin(geometry, parameters);
  for (int bin = 0; bin < power.rows(); ++bin) {
    for (int beam = 0; beam < power.cols(); ++beam) {
      image.value(bin, beam) = static_cast<float>(gain[bin] * power(bin, beam) + noise(bin, beam));
    }
  }
  return image;
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
                               const ParameterSet& parameters, double full_scale, const DrawSeeds& seeds) {
  using Complex = std::complex<double>;
  if (!(parameters.receiver.looks >= 1.0)) {
    throw DataError("receiver.looks {}: a draw needs at least one look", parameters.receiver.looks);
  }
  const auto [whole_looks, last_weight] = LooksAsWeights(parameters.receiver.looks);
  const Grid<double> noise = NoiseFloorPower(geometry, parameters);
  const std::vector<double> gain = GainByBin(geometry, parameters);
  Grid<double> power(geometry.sonar.axes.range_bins, geometry.sonar.axes.beam_count());
  const int looks = whole_looks + (last_weight > 0.0 ? 1 : 0);
  for (int look = 0; look < looks; ++look) {
    const double weight = (look < whole_looks ? 1.0 : last_weight) / (whole_looks + last_weight);
    const CounterRandom scatterers(seeds.scatterers, static_cast<std::uint32_t>(2 * look));
    const CounterRandom receiver(seeds.receiver, static_cast<std::uint32_t>(2 * look + 1));
    Grid<Complex> field(scatter.power.rows(), scatter.power.cols());
    for (std::size_t i = 0; i < field.size(); ++i) {
      if (scatter.power.values()[i] == 0.0) continue;
      const auto [re, im] = scatterers.Normal2(i);
      field.values()[i] = std::sqrt(0.5 * scatter.power.values()[i]) * Complex(re, im);
    }
    const Grid<Complex> received = ThroughResponses(field, geometry, parameters, scatter, true);
    for (std::size_t i = 0; i < power.size(); ++i) {
      const auto [re, im] = receiver.Normal2(i);
      power.values()[i] += weight * std::norm(std::sqrt(gain[i / power.cols()]) * received.values()[i] +
                                              std::sqrt(0.5 * noise.values()[i]) * Complex(re, im));
    }
  }
  return Displayed(power, geometry.sonar.axes, parameters, full_scale, AsShown(parameters.display));
}

}  // namespace sonarcal
