#include "sim/power_response.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "data_io/types/error.h"
#include "data_io/types/units.h"
#include "sim/physics/beam_pattern.h"

namespace sonarcal {
namespace {

// out += weight x in, value by value.
inline void Add(double* out, const double* in, double weight, int count) {
  for (int k = 0; k < count; ++k) out[k] += weight * in[k];
}

}  // namespace

PowerResponse::PowerResponse(int bins, int range_steps, std::vector<Window> azimuth, Window pulse)
    : bins_(bins), range_steps_(range_steps), azimuth_(std::move(azimuth)), pulse_(std::move(pulse)) {}

std::pair<int, int> PowerResponse::RowsOfBin(int bin) const {
  const int first = bin * range_steps_ + pulse_.first;
  const int rows = bins_ * range_steps_;
  return {std::clamp(first, 0, rows), std::clamp(first + static_cast<int>(pulse_.weight.size()), 0, rows)};
}

std::vector<std::size_t> RowStarts(const EchoPower& echoes) {
  std::vector<std::size_t> start(echoes.rows + 1, echoes.cells.size());
  for (std::size_t i = echoes.cells.size(); i-- > 0;) start[echoes.cells[i].row] = i;
  for (int row = echoes.rows; row-- > 0;) start[row] = std::min(start[row], start[row + 1]);
  return start;
}

ImageStack PowerResponse::Apply(const EchoPower& echoes, std::span<const double> cells, int count) const {
  SONARCAL_CHECK(cells.size() == echoes.cells.size() * count, "{} values for {} cells", cells.size(),
                 echoes.cells.size());
  SONARCAL_CHECK(echoes.rows == bins_ * range_steps_, "echoes of {} rows, expected {}", echoes.rows,
                 bins_ * range_steps_);
  const int beams = static_cast<int>(azimuth_.size());
  const std::vector<std::size_t> row_start = RowStarts(echoes);

  ImageStack stack{count, std::vector<double>(static_cast<std::size_t>(bins_) * beams * count, 0.0)};
  tbb::parallel_for(tbb::blocked_range<int>(0, bins_, 8), [&](const tbb::blocked_range<int>& range) {
    std::vector<double> by_column(static_cast<std::size_t>(echoes.cols) * count);
    for (int bin = range.begin(); bin != range.end(); ++bin) {
      std::fill(by_column.begin(), by_column.end(), 0.0);
      const auto [first_row, last_row] = RowsOfBin(bin);
      if (row_start[first_row] == row_start[last_row]) continue;
      for (std::size_t i = row_start[first_row]; i < row_start[last_row]; ++i) {
        const EchoPower::Cell& cell = echoes.cells[i];
        Add(&by_column[static_cast<std::size_t>(cell.col) * count], &cells[i * count],
            PulseWeight(bin, cell.row), count);
      }
      double* out = &stack.values[static_cast<std::size_t>(bin) * beams * count];
      for (int beam = 0; beam < beams; ++beam) {
        const Window& window = azimuth_[beam];
        const double* in = &by_column[static_cast<std::size_t>(window.first) * count];
        for (std::size_t i = 0; i < window.weight.size(); ++i) {
          Add(out + static_cast<std::size_t>(beam) * count, in + i * count, window.weight[i], count);
        }
      }
    }
  });
  return stack;
}

void CompleteResponse(const SonarModel& sonar, ParameterSet& parameters) {
  BeamParameters& beam = parameters.beam;
  if (!(beam.azimuth_width_deg > 0.0)) beam.azimuth_width_deg = sonar.azimuth_beam_width_deg;
  if (!(beam.azimuth_width_deg > 0.0) && beam.azimuth_pattern != AzimuthPattern::kTable) {
    throw DataError("{}: azimuth beam width unknown; give it in the sonar or as beam.azimuth_width_deg",
                    sonar.name);
  }
  if (!(beam.elevation_width_deg > 0.0)) beam.elevation_width_deg = sonar.elevation_beam_width_deg;
  if (!(parameters.pulse.length_m > 0.0)) parameters.pulse.length_m = sonar.axes.range_bin_m();
}

int RangeStepsFor(const SonarModel& sonar, const ParameterSet& parameters) {
  constexpr double kFewest = 4.0;
  constexpr double kMost = 64.0;
  const double pulse_m =
      parameters.pulse.length_m > 0.0 ? parameters.pulse.length_m : sonar.axes.range_bin_m();
  return static_cast<int>(
      std::clamp(std::ceil(4.0 * sonar.axes.range_bin_m() / pulse_m - 1e-9), kFewest, kMost));
}

PowerResponse MakePowerResponse(const SonarModel& sonar, const ParameterSet& given,
                                const std::vector<double>& columns, int range_steps) {
  constexpr double kSideLobeReachDb = -60.0;
  constexpr double kPulseReach = 3.0;  // lengths: 2^-36 of the peak
  ParameterSet parameters = given;
  CompleteResponse(sonar, parameters);
  const BeamParameters& beam = parameters.beam;
  const PolarAxes& axes = sonar.axes;
  const AzimuthResponse<double> response({.pattern = beam.azimuth_pattern,
                                          .width_rad = RadFromDeg(beam.azimuth_width_deg),
                                          .taper = beam.azimuth_taper,
                                          .table_db = &beam.azimuth_table_db,
                                          .beam_spacing_rad = 0.0,
                                          .beam_azimuth_rad = &axes.beam_azimuth_rad});
  std::vector<PowerResponse::Window> azimuth(axes.beam_count());
  for (int i = 0; i < axes.beam_count(); ++i) {
    const double centre = axes.beam_azimuth_rad[i];
    const auto [low, high] = AzimuthReachRad(response, centre, kSideLobeReachDb);
    auto column = std::lower_bound(columns.begin(), columns.end(), low);
    azimuth[i].first = static_cast<int>(column - columns.begin());
    for (; column != columns.end() && *column <= high; ++column)
      azimuth[i].weight.push_back(response.Power(*column, centre));
  }
  const double length_m = parameters.pulse.length_m;
  const double step_m = axes.range_bin_m() / range_steps;
  const int reach = static_cast<int>(std::ceil(kPulseReach * length_m / step_m)) + range_steps;
  PowerResponse::Window pulse{.first = -reach, .weight = {}};
  for (int row = -reach; row <= reach + range_steps; ++row) {
    pulse.weight.push_back(GaussianResponse((row + 0.5) * step_m - 0.5 * axes.range_bin_m(), length_m));
  }
  return {axes.range_bins, range_steps, std::move(azimuth), std::move(pulse)};
}

}  // namespace sonarcal
