#include "sim/gathered/power_response.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::sim {
namespace {

// out += weight x in, value by value.
inline void Add(double* out, const double* in, double weight, int count) {
  for (int k = 0; k < count; ++k) out[k] += weight * in[k];
}

}  // namespace

PowerResponse::PowerResponse(int bins, int range_steps, std::vector<ResponseWindow> azimuth,
                             ResponseWindow pulse)
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
        const ResponseWindow& window = azimuth_[beam];
        const double* in = &by_column[static_cast<std::size_t>(window.first) * count];
        for (std::size_t i = 0; i < window.weight.size(); ++i) {
          Add(out + static_cast<std::size_t>(beam) * count, in + i * count, window.weight[i], count);
        }
      }
    }
  });
  return stack;
}

PowerResponse MakePowerResponse(const SonarModel& sonar, const ParameterSet& parameters,
                                const std::vector<double>& column_azimuth_rad, int range_steps) {
  return {sonar.axes.range_bins, range_steps,
          AzimuthWindows(sonar, parameters, column_azimuth_rad, ResponseOf::kPower),
          PulseWindow(sonar, parameters, range_steps, ResponseOf::kPower)};
}

}  // namespace sonarcal::sim
