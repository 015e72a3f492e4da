#include "sim/paper/paper_blur.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::sim {
namespace {

// Reach of the blur in standard deviations.
constexpr double kBlurReach = 4.0;

// Range errors of at least this many bins hide the position of an echo within its bin. The cells of a bin are
// then blurred together.
constexpr double kWideBlurBins = 4.0;

// Rows of cells whose azimuth errors differ relatively by less than this share one kernel. A first-order
// correction leaves an error of the square of this difference.
constexpr double kSharedKernel = 0.01;

template <typename Body>
void ForRows(int count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<int>(0, count, 8), [&](const tbb::blocked_range<int>& rows) {
    for (int row = rows.begin(); row != rows.end(); ++row) body(row);
  });
}

// Weights from one interval to another. `even`: for echoes spread evenly over the interval. `moment`:
// derivative with respect to the offset of their mean, in units of the interval; one half then counts more
// than the other.
struct HalvesWeight {
  BlurWeight even;
  BlurWeight moment;
};

HalvesWeight WeightOfHalves(double from_low, double from_high, double to_low, double to_high, double sigma) {
  const double middle = 0.5 * (from_low + from_high);
  const BlurWeight lower = GaussianBlurWeight(from_low, middle, to_low, to_high, sigma);
  const BlurWeight upper = GaussianBlurWeight(middle, from_high, to_low, to_high, sigma);
  return {.even = {0.5 * (lower.value + upper.value), 0.5 * (lower.slope + upper.slope)},
          .moment = {2.0 * (upper.value - lower.value), 2.0 * (upper.slope - lower.slope)}};
}

// Indices [first, last) of the intervals between `edges` that touch [low, high].
std::pair<int, int> IntervalsWithin(const std::vector<double>& edges, double low, double high) {
  const int count = static_cast<int>(edges.size()) - 1;
  const int first = static_cast<int>(std::upper_bound(edges.begin(), edges.end(), low) - edges.begin()) - 1;
  const int last = static_cast<int>(std::lower_bound(edges.begin(), edges.end(), high) - edges.begin());
  return {std::clamp(first, 0, count), std::clamp(last, 0, count)};
}

}  // namespace

PaperBlur::PaperBlur(const EchoHistogram& histogram, const ImageGeometry& geometry,
                     std::span<const double> sigma_range_m, std::span<const double> sigma_azimuth_rad)
    : histogram_(histogram),
      geometry_(geometry),
      sigma_range_m_(sigma_range_m.begin(), sigma_range_m.end()),
      sigma_azimuth_rad_(sigma_azimuth_rad.begin(), sigma_azimuth_rad.end()) {
  SONARCAL_CHECK(histogram.rows == geometry.axes.range_bins * kRangeSteps &&
                     histogram.beams == geometry.axes.beam_count(),
                 "histogram of {} x {} cells", histogram.rows, histogram.beams);
  SONARCAL_CHECK(static_cast<int>(sigma_range_m.size()) == histogram.rows &&
                     static_cast<int>(sigma_azimuth_rad.size()) == histogram.rows,
                 "errors for {} and {} rows of {}", sigma_range_m.size(), sigma_azimuth_rad.size(),
                 histogram.rows);
  const double narrowest_m = *std::min_element(sigma_range_m_.begin(), sigma_range_m_.end());
  if (narrowest_m >= kWideBlurBins * geometry.axes.range_bin_m()) group_ = kRangeSteps;
  MakeAzimuthKernels();
  MakeRangeWeights();
}

PaperBlur::AzimuthKernel PaperBlur::MakeAzimuthKernel(double sigma_rad) const {
  const std::vector<double>& edges = geometry_.beam_edges_rad;
  const double reach_rad = kBlurReach * sigma_rad;
  AzimuthKernel kernel{.sigma_rad = sigma_rad,
                       .first = {},
                       .last = {},
                       .start = {},
                       .value = {},
                       .slope = {},
                       .moment = {},
                       .moment_slope = {}};
  const auto put = [&](int from, int to, double side) {
    const auto [even, moment] =
        WeightOfHalves(edges[from], edges[from + 1], edges[to], edges[to + 1], sigma_rad);
    kernel.value.push_back(even.value);
    kernel.slope.push_back(even.slope);
    kernel.moment.push_back(side * moment.value);
    kernel.moment_slope.push_back(side * moment.slope);
  };
  int reach_beams = 0;
  if (geometry_.beams_are_even) {
    // Weights of one beam to its right, mirrored, serve every beam.
    while (reach_beams + 1 < beams() && edges[reach_beams + 1] - edges[1] <= reach_rad) ++reach_beams;
    for (int to = -reach_beams; to <= reach_beams; ++to) put(0, std::abs(to), to < 0 ? -1.0 : 1.0);
  }
  for (int from = 0; from < beams(); ++from) {
    auto [first, last] = IntervalsWithin(edges, edges[from] - reach_rad, edges[from + 1] + reach_rad);
    if (geometry_.beams_are_even) {
      first = std::max(first, from - reach_beams);
      last = std::min(last, from + reach_beams + 1);
      kernel.start.push_back(reach_beams - from);
    } else {
      kernel.start.push_back(static_cast<std::ptrdiff_t>(kernel.value.size()) - first);
      for (int to = first; to < last; ++to) put(from, to, 1.0);
    }
    kernel.first.push_back(first);
    kernel.last.push_back(last);
  }
  return kernel;
}

void PaperBlur::MakeAzimuthKernels() {
  for (const double sigma_rad : sigma_azimuth_rad_) {
    if (!(sigma_rad > 0.0)) {
      kernel_of_row_.push_back(-1);
      continue;
    }
    if (kernels_.empty() || std::abs(sigma_rad / kernels_.back().sigma_rad - 1.0) > kSharedKernel) {
      kernels_.push_back(MakeAzimuthKernel(sigma_rad));
    }
    kernel_of_row_.push_back(static_cast<int>(kernels_.size()) - 1);
  }
}

void PaperBlur::MakeRangeWeights() {
  const int bins = geometry_.axes.range_bins;
  const double bin_m = geometry_.axes.range_bin_m();
  const double step_m = bin_m / kRangeSteps;
  const double reach_m = kBlurReach * *std::max_element(sigma_range_m_.begin(), sigma_range_m_.end());
  const int reach_rows = static_cast<int>(std::ceil(reach_m / step_m / group_));
  const int own_rows = kRangeSteps / group_;
  const auto is_empty = [&](int row) {
    return histogram_.row_start[row * group_] == histogram_.row_start[(row + 1) * group_];
  };
  std::vector<std::vector<RangeWeight>> of_bin(static_cast<std::size_t>(bins));
  ForRows(bins, [&](int bin) {
    const int first_own = bin * own_rows;
    const int end = std::min(row_count(), first_own + own_rows + reach_rows);
    for (int row = std::max(0, first_own - reach_rows); row < end; ++row) {
      if (is_empty(row)) continue;
      const double sigma_m = AtMiddle(sigma_range_m_, row);
      const double low_m = row * group_ * step_m;
      if (sigma_m > 0.0) {
        const auto [even, moment] =
            WeightOfHalves(low_m, low_m + group_ * step_m, bin * bin_m, (bin + 1) * bin_m, sigma_m);
        of_bin[bin].push_back({row, even, moment});
      } else if (row >= first_own && row < first_own + own_rows) {
        of_bin[bin].push_back({row, {.value = 1.0, .slope = 0.0}, {}});
      }
    }
  });
  for (const std::vector<RangeWeight>& weights : of_bin) {
    range_start_.push_back(range_weights_.size());
    range_weights_.insert(range_weights_.end(), weights.begin(), weights.end());
  }
  range_start_.push_back(range_weights_.size());
}

// Beams [first, last) that receive echoes of a row's cells through the errors.
std::pair<int, int> PaperBlur::TouchedBeams(std::span<const double> cells, int out_row) const {
  int touched_first = beams();
  int touched_last = 0;
  for (int row = out_row * group_; row < (out_row + 1) * group_; ++row) {
    const AzimuthKernel* kernel = kernel_of_row_[row] < 0 ? nullptr : &kernels_[kernel_of_row_[row]];
    for (std::uint32_t i = histogram_.row_start[row]; i < histogram_.row_start[row + 1]; ++i) {
      if (cells[i] == 0.0) continue;
      const int from = histogram_.cells[i].col;
      touched_first = std::min(touched_first, kernel != nullptr ? kernel->first[from] : from);
      touched_last = std::max(touched_last, kernel != nullptr ? kernel->last[from] : from + 1);
    }
  }
  return {touched_first, touched_last};
}

// Extends the touched beams of a row and sets the added ones to 0.
void PaperBlur::Widen(Rows& rows, int out_row, int beams, std::pair<int, int> touched) {
  const auto [first, last] = touched;
  if (first >= last) return;
  double* values = &rows.values[static_cast<std::size_t>(out_row) * beams];
  std::int32_t& row_first = rows.first[out_row];
  std::int32_t& row_last = rows.last[out_row];
  if (row_first >= row_last) row_first = row_last = first;
  double* moments = &rows.moments[static_cast<std::size_t>(out_row) * beams];
  for (int beam = first; beam < row_first; ++beam) values[beam] = moments[beam] = 0.0;
  for (int beam = row_last; beam < last; ++beam) values[beam] = moments[beam] = 0.0;
  row_first = std::min(row_first, first);
  row_last = std::max(row_last, last);
}

double PaperBlur::AtMiddle(std::span<const double> of_rows_of_cells, int row) const {
  const double* group = &of_rows_of_cells[static_cast<std::size_t>(row) * group_];
  return 0.5 * (group[(group_ - 1) / 2] + group[group_ / 2]);
}

// Adds each cell to the beams that its errors reach. `weight_of(row)` returns two factors: a target's weight
// is the first times the kernel's value plus the second times its slope.
template <typename WeightOf>
void PaperBlur::Spread(std::span<const double> cells, Rows& rows, WeightOf weight_of) const {
  SONARCAL_CHECK(cells.size() == histogram_.cells.size(), "{} values for {} cells", cells.size(),
                 histogram_.cells.size());
  ForRows(row_count(), [&](int out_row) {
    Widen(rows, out_row, beams(), TouchedBeams(cells, out_row));
    double* out = &rows.values[static_cast<std::size_t>(out_row) * beams()];
    double* out_moment = &rows.moments[static_cast<std::size_t>(out_row) * beams()];
    for (int row = out_row * group_; row < (out_row + 1) * group_; ++row) {
      const auto [of_value, of_slope] = weight_of(row);
      const AzimuthKernel* kernel = kernel_of_row_[row] < 0 ? nullptr : &kernels_[kernel_of_row_[row]];
      for (std::uint32_t i = histogram_.row_start[row]; i < histogram_.row_start[row + 1]; ++i) {
        const double cell = cells[i];
        if (cell == 0.0) continue;
        const int from = histogram_.cells[i].col;
        const double range_offset = RangeOffset(histogram_.cells[i]);
        const double azimuth_offset = histogram_.cells[i].azimuth_offset;
        if (kernel == nullptr) {
          out[from] += of_value * cell;
          out_moment[from] += of_value * cell * range_offset;
          continue;
        }
        const int first = kernel->first[from];
        const int last = kernel->last[from];
        const double* value = &kernel->value[kernel->start[from] + first];
        const double* slope = &kernel->slope[kernel->start[from] + first];
        const double a = cell * of_value;
        const double b = cell * of_slope;
        const double* moment = &kernel->moment[kernel->start[from] + first];
        const double* moment_slope = &kernel->moment_slope[kernel->start[from] + first];
        const double a_aside = a * azimuth_offset;
        const double b_aside = b * azimuth_offset;
        for (int k = 0; k < last - first; ++k) {
          const double at = a * value[k] + b * slope[k] + a_aside * moment[k] + b_aside * moment_slope[k];
          out[first + k] += at;
          out_moment[first + k] += range_offset * at;
        }
      }
    }
  });
}

void PaperBlur::WeighBeams(const EchoHistogram::Cell& cell, BeamWeights& beams) const {
  const int number = kernel_of_row_[cell.row];
  if (number < 0) {
    beams.first = cell.col;
    beams.weight.assign(1, 1.0F);
    return;
  }
  const AzimuthKernel& kernel = kernels_[number];
  const double growth_rad = sigma_azimuth_rad_[cell.row] - kernel.sigma_rad;
  beams.first = kernel.first[cell.col];
  const int count = kernel.last[cell.col] - beams.first;
  beams.weight.resize(count);
  const std::ptrdiff_t start = kernel.start[cell.col] + beams.first;
  const double* value = kernel.value.data() + start;
  const double* slope = kernel.slope.data() + start;
  const double* moment = kernel.moment.data() + start;
  const double* moment_slope = kernel.moment_slope.data() + start;
  const double offset = cell.azimuth_offset;
  float* weight = beams.weight.data();
  for (int i = 0; i < count; ++i) {
    weight[i] = static_cast<float>(value[i] + growth_rad * slope[i] +
                                   offset * (moment[i] + growth_rad * moment_slope[i]));
  }
}

PaperBlur::Rows PaperBlur::AlongAzimuth(std::span<const double> cells) const {
  const auto count = static_cast<std::size_t>(row_count());
  Rows rows{.values = std::make_unique_for_overwrite<double[]>(count * beams()),
            .moments = std::make_unique_for_overwrite<double[]>(count * beams()),
            .first = std::vector<std::int32_t>(count),
            .last = std::vector<std::int32_t>(count)};
  Spread(cells, rows, [&](int row) {
    const int kernel = kernel_of_row_[row];
    return std::pair(1.0, kernel < 0 ? 0.0 : sigma_azimuth_rad_[row] - kernels_[kernel].sigma_rad);
  });
  return rows;
}

void PaperBlur::AddAzimuthGrowth(std::span<const double> cells, std::span<const double> growth_rad,
                                 Rows& rows) const {
  Spread(cells, rows, [&](int row) { return std::pair(0.0, growth_rad[row]); });
}

std::vector<double> PaperBlur::AlongRange(const Rows& rows) const {
  const int bins = geometry_.axes.range_bins;
  std::vector<double> image(static_cast<std::size_t>(bins) * beams());
  ForRows(bins, [&](int bin) {
    double* out = &image[static_cast<std::size_t>(bin) * beams()];
    for (std::size_t i = range_start_[bin]; i < range_start_[bin + 1]; ++i) {
      const auto& [row, weight, moment] = range_weights_[i];
      const double* in = &rows.values[static_cast<std::size_t>(row) * beams()];
      const double* aside = &rows.moments[static_cast<std::size_t>(row) * beams()];
      const double w = weight.value;
      const double m = moment.value;
      for (int beam = rows.first[row]; beam < rows.last[row]; ++beam)
        out[beam] += w * in[beam] + m * aside[beam];
    }
  });
  return image;
}

void PaperBlur::AddRangeGrowth(const Rows& rows, std::span<const double> growth_m,
                               std::vector<double>& image) const {
  ForRows(geometry_.axes.range_bins, [&](int bin) {
    double* out = &image[static_cast<std::size_t>(bin) * beams()];
    for (std::size_t i = range_start_[bin]; i < range_start_[bin + 1]; ++i) {
      const auto& [row, weight, moment] = range_weights_[i];
      const double* in = &rows.values[static_cast<std::size_t>(row) * beams()];
      const double* aside = &rows.moments[static_cast<std::size_t>(row) * beams()];
      const double growth = AtMiddle(growth_m, row);
      const double w = weight.slope * growth;
      const double m = moment.slope * growth;
      for (int beam = rows.first[row]; beam < rows.last[row]; ++beam)
        out[beam] += w * in[beam] + m * aside[beam];
    }
  });
}

}  // namespace sonarcal::sim
