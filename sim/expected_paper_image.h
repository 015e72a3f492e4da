// The mean of the paper's image over its range and azimuth errors, from an EchoHistogram: the forward model
// that renders and that Ceres differentiates.
//
// Each pixel's echoes are taken to be spread evenly over the pixel, and each is spread over its neighbours by
// the Gaussian errors of its own range (sim/physics/jitter.h). Without errors it is the sharp image. The
// clamp to [0, I] is applied to the mean, as if the many rays of a pixel had averaged out.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/echo_histogram.h"
#include "sim/physics/jitter.h"
#include "sim/physics/paper_echo.h"

namespace sonarcal {

// What of a frame the expected image needs besides its echoes.
struct ImageGeometry {
  ImageGeometry(const SonarModel& sonar, double absorption_db_per_m_)
      : axes(sonar.axes),
        beam_edges_rad(sonar.axes.BeamEdgesRad()),
        frequency_hz(sonar.frequency_hz),
        absorption_db_per_m(absorption_db_per_m_) {}

  PolarAxes axes;
  std::vector<double> beam_edges_rad;
  double frequency_hz;
  double absorption_db_per_m;
};

namespace internal {

inline double ScalarPart(double value) {
  return value;
}
template <typename Jet>
double ScalarPart(const Jet& value) {
  return value.a;
}

// Blurs reach this many standard deviations.
inline constexpr double kBlurReach = 5.0;

// Indices [first, last) of the intervals between `edges` that touch [low, high].
inline std::pair<int, int> IntervalsWithin(const std::vector<double>& edges, double low, double high) {
  const int count = static_cast<int>(edges.size()) - 1;
  const int first = static_cast<int>(std::upper_bound(edges.begin(), edges.end(), low) - edges.begin()) - 1;
  const int last = static_cast<int>(std::lower_bound(edges.begin(), edges.end(), high) - edges.begin());
  return {std::clamp(first, 0, count), std::clamp(last, 0, count)};
}

// Sum of normalised echoes of each cell, without errors.
template <typename T>
std::vector<T> ShadeCells(const EchoHistogram& histogram, const ImageGeometry& geometry,
                          const PaperParameters<T>& parameters) {
  std::vector<T> strength_db(static_cast<std::size_t>(histogram.materials) * kIncidenceNodes);
  for (int material = 0; material < histogram.materials; ++material) {
    for (int node = 0; node < kIncidenceNodes; ++node) {
      strength_db[static_cast<std::size_t>(material) * kIncidenceNodes + node] =
          GsabDb(parameters.materials[material], node * kIncidenceStepDeg);
    }
  }
  std::vector<T> values(histogram.cells.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, values.size(), 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const EchoHistogram::Cell& cell = histogram.cells[i];
      T sum_db(0.0);
      for (std::uint32_t entry = cell.first_entry; entry < cell.last_entry; ++entry) {
        sum_db += T(double{histogram.entries[entry].weight}) * strength_db[histogram.entries[entry].node];
      }
      const double loss_db =
          (cell.log_range + geometry.absorption_db_per_m * cell.two_way_range_m) / cell.weight;
      values[i] = T(cell.weight) * NormalisedPaperEcho(parameters, T(loss_db), sum_db / T(cell.weight));
    }
  });
  return values;
}

}  // namespace internal

// Pixels in units of full scale, 0..1, row-major (range_bins x beams).
template <typename T>
std::vector<T> ExpectedPaperImage(const EchoHistogram& histogram, const ImageGeometry& geometry,
                                  const PaperParameters<T>& parameters) {
  using internal::ScalarPart;
  const int bins = histogram.bins;
  const int beams = histogram.beams;
  const auto cell_values = internal::ShadeCells(histogram, geometry, parameters);
  const auto for_rows = [&](auto&& body) {
    tbb::parallel_for(tbb::blocked_range<int>(0, bins, 4), [&](const tbb::blocked_range<int>& rows) {
      for (int row = rows.begin(); row != rows.end(); ++row) body(row);
    });
  };
  const auto row_is_empty = [&](int row) { return histogram.row_start[row] == histogram.row_start[row + 1]; };

  // Along azimuth, each row with the error of its range.
  std::vector<T> spread(static_cast<std::size_t>(bins) * beams, T(0.0));
  for_rows([&](int row) {
    if (row_is_empty(row)) return;
    T* out = &spread[static_cast<std::size_t>(row) * beams];
    const T sigma =
        JitterSigmaAzimuthRad(parameters.jitter, geometry.axes.range_centre_m(row), geometry.frequency_hz);
    const double reach = internal::kBlurReach * ScalarPart(sigma);
    const std::vector<double>& edges = geometry.beam_edges_rad;
    for (std::uint32_t i = histogram.row_start[row]; i < histogram.row_start[row + 1]; ++i) {
      const int col = histogram.cells[i].col;
      if (!(reach > 0.0)) {
        out[col] += cell_values[i];
        continue;
      }
      const auto [first, last] = internal::IntervalsWithin(edges, edges[col] - reach, edges[col + 1] + reach);
      for (int to = first; to < last; ++to) {
        out[to] += cell_values[i] * BlurWeight(edges[col], edges[col + 1], edges[to], edges[to + 1], sigma);
      }
    }
  });

  // Along range: every row gathers from the rows whose errors reach it.
  std::vector<T> sigma_range(bins);
  double reach_m = 0.0;
  for (int row = 0; row < bins; ++row) {
    sigma_range[row] =
        JitterSigmaRangeM(parameters.jitter, geometry.axes.range_centre_m(row), geometry.frequency_hz);
    reach_m = std::max(reach_m, internal::kBlurReach * ScalarPart(sigma_range[row]));
  }
  const double bin_m = geometry.axes.range_bin_m();
  const int reach_bins = static_cast<int>(std::ceil(reach_m / bin_m));
  std::vector<T> image(spread.size(), T(0.0));
  for_rows([&](int row) {
    T* out = &image[static_cast<std::size_t>(row) * beams];
    for (int from = std::max(0, row - reach_bins); from <= std::min(bins - 1, row + reach_bins); ++from) {
      if (row_is_empty(from)) continue;
      const T* in = &spread[static_cast<std::size_t>(from) * beams];
      if (!(ScalarPart(sigma_range[from]) > 0.0)) {
        if (from == row) {
          for (int col = 0; col < beams; ++col) out[col] += in[col];
        }
        continue;
      }
      const T weight =
          BlurWeight(from * bin_m, (from + 1) * bin_m, row * bin_m, (row + 1) * bin_m, sigma_range[from]);
      for (int col = 0; col < beams; ++col) out[col] += weight * in[col];
    }
    for (int col = 0; col < beams; ++col) {
      if (out[col] < T(0.0)) out[col] = T(0.0);
      if (out[col] > T(1.0)) out[col] = T(1.0);
    }
  });
  return image;
}

}  // namespace sonarcal
