// The mean of the paper's image over its range and azimuth errors, from an EchoHistogram: the forward model
// that renders and that Ceres differentiates.
//
// Each cell's echoes are taken to be spread evenly over the cell, and each is spread over its neighbours by
// the Gaussian errors of its own range (sim/physics/jitter.h). Without errors it is the sharp image. The
// clamp to [0, I] is applied to the mean, as if the many rays of a pixel had averaged out.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
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
        absorption_db_per_m(absorption_db_per_m_) {
    const double width = beam_edges_rad[1] - beam_edges_rad[0];
    for (std::size_t i = 1; i < beam_edges_rad.size(); ++i) {
      beams_are_even =
          beams_are_even && std::abs(beam_edges_rad[i] - beam_edges_rad[i - 1] - width) < 1e-6 * width;
    }
  }

  PolarAxes axes;
  std::vector<double> beam_edges_rad;
  double frequency_hz;
  double absorption_db_per_m;
  bool beams_are_even = true;  // one blur kernel serves every beam of a row
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
inline constexpr double kBlurReach = 4.0;

// From this many bins on, a range error hides where in its bin an echo was: the cells of a bin are blurred as
// one.
inline constexpr double kWideBlurBins = 4.0;

// Indices [first, last) of the intervals between `edges` that touch [low, high].
inline std::pair<int, int> IntervalsWithin(const std::vector<double>& edges, double low, double high) {
  const int count = static_cast<int>(edges.size()) - 1;
  const int first = static_cast<int>(std::upper_bound(edges.begin(), edges.end(), low) - edges.begin()) - 1;
  const int last = static_cast<int>(std::lower_bound(edges.begin(), edges.end(), high) - edges.begin());
  return {std::clamp(first, 0, count), std::clamp(last, 0, count)};
}

// Blur along azimuth for errors of about one size, from any beam to any other; on even beams it depends on
// their distance only.
class AzimuthBlur {
 public:
  AzimuthBlur(const ImageGeometry& geometry, double sigma_rad)
      : edges_(&geometry.beam_edges_rad), even_(geometry.beams_are_even), sigma_rad_(sigma_rad) {
    const int beams = geometry.axes.beam_count();
    for (int from = 0; from < (even_ ? 1 : beams); ++from) {
      const auto [first, last] = even_ ? std::pair(0, beams) : Targets(from);
      first_entry_.push_back(static_cast<int>(weights_.size()) - first);
      for (int to = first; to < last; ++to) {
        if (even_ && Edge(to) - Edge(1) > kBlurReach * sigma_rad_) break;
        weights_.push_back(
            GaussianBlurWeight(Edge(from), Edge(from + 1), Edge(to), Edge(to + 1), sigma_rad_));
      }
    }
  }

  double sigma_rad() const { return sigma_rad_; }

  // Beams [first, last) that errors carry an echo to.
  std::pair<int, int> Targets(int from) const {
    const double reach_rad = kBlurReach * sigma_rad_;
    return IntervalsWithin(*edges_, Edge(from) - reach_rad, Edge(from + 1) + reach_rad);
  }

  const BlurWeight& Weight(int from, int to) const {
    static constexpr BlurWeight kNone;
    if (!even_) return weights_[first_entry_[from] + to];
    const auto distance = static_cast<std::size_t>(std::abs(to - from));
    return distance < weights_.size() ? weights_[distance] : kNone;
  }

 private:
  double Edge(int i) const { return (*edges_)[i]; }

  const std::vector<double>* edges_;
  bool even_;
  double sigma_rad_;
  std::vector<int> first_entry_;  // of a beam, less its first target
  std::vector<BlurWeight> weights_;
};

// Rows of cells whose errors differ by less than this share one blur, corrected to first order: what remains
// is the square of it.
inline constexpr double kSharedBlur = 0.01;

// Blurs for rows with these errors, and which row has which; -1 for a row without errors.
struct AzimuthBlurs {
  std::vector<AzimuthBlur> blurs;
  std::vector<int> of_row;

  AzimuthBlurs(const ImageGeometry& geometry, const std::vector<double>& sigma_rad) {
    for (const double sigma : sigma_rad) {
      if (!(sigma > 0.0)) {
        of_row.push_back(-1);
        continue;
      }
      if (blurs.empty() || std::abs(sigma / blurs.back().sigma_rad() - 1.0) > kSharedBlur) {
        blurs.emplace_back(geometry, sigma);
      }
      of_row.push_back(static_cast<int>(blurs.size()) - 1);
    }
  }
};

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
  const int bins = geometry.axes.range_bins;
  const int beams = geometry.axes.beam_count();
  SONARCAL_CHECK(histogram.rows == bins * kRangeSteps && histogram.beams == beams,
                 "histogram of {} x {} cells", histogram.rows, histogram.beams);
  const auto cell_values = internal::ShadeCells(histogram, geometry, parameters);
  const double bin_m = geometry.axes.range_bin_m();
  const double step_m = bin_m / kRangeSteps;
  const auto parallel_rows = [](int count, auto&& body) {
    tbb::parallel_for(tbb::blocked_range<int>(0, count, 8), [&](const tbb::blocked_range<int>& rows) {
      for (int row = rows.begin(); row != rows.end(); ++row) body(row);
    });
  };

  // Along azimuth, each row of cells with the errors of its range.
  std::vector<T> sigma_azimuth(histogram.rows);
  std::vector<T> sigma_range_m(histogram.rows);
  std::vector<double> sigma_azimuth_rad(histogram.rows);
  for (int row = 0; row < histogram.rows; ++row) {
    const double range_m = geometry.axes.range_min_m + (row + 0.5) * step_m;
    sigma_range_m[row] = JitterSigmaRangeM(parameters.jitter, range_m, geometry.frequency_hz);
    sigma_azimuth[row] = JitterSigmaAzimuthRad(parameters.jitter, range_m, geometry.frequency_hz);
    sigma_azimuth_rad[row] = ScalarPart(sigma_azimuth[row]);
  }
  const internal::AzimuthBlurs azimuth(geometry, sigma_azimuth_rad);
  std::vector<T> spread(static_cast<std::size_t>(histogram.rows) * beams, T(0.0));
  parallel_rows(histogram.rows, [&](int row) {
    T* out = &spread[static_cast<std::size_t>(row) * beams];
    for (std::uint32_t i = histogram.row_start[row]; i < histogram.row_start[row + 1]; ++i) {
      const int from = histogram.cells[i].col;
      if (azimuth.of_row[row] < 0) {
        out[from] += cell_values[i];
        continue;
      }
      const internal::AzimuthBlur& blur = azimuth.blurs[azimuth.of_row[row]];
      const auto [first, last] = blur.Targets(from);
      for (int to = first; to < last; ++to) {
        out[to] += cell_values[i] * blur.Weight(from, to).At(sigma_azimuth[row], blur.sigma_rad());
      }
    }
  });

  // Along range: every bin gathers from the rows of cells whose errors reach it, or from whole bins where the
  // errors are wide.
  double reach_m = 0.0;
  double narrowest_m = std::numeric_limits<double>::infinity();
  for (const T& sigma : sigma_range_m) {
    reach_m = std::max(reach_m, internal::kBlurReach * ScalarPart(sigma));
    narrowest_m = std::min(narrowest_m, ScalarPart(sigma));
  }
  const int group = narrowest_m >= internal::kWideBlurBins * bin_m ? kRangeSteps : 1;
  if (group > 1) {
    parallel_rows(bins, [&](int bin) {
      T* sum = &spread[static_cast<std::size_t>(bin) * kRangeSteps * beams];
      for (int i = beams; i < kRangeSteps * beams; ++i) sum[i % beams] += sum[i];
    });
  }
  const auto group_is_empty = [&](int row) {
    return histogram.row_start[row] == histogram.row_start[row + group];
  };
  const int reach_rows = static_cast<int>(std::ceil(reach_m / step_m / group)) * group;
  std::vector<T> image(static_cast<std::size_t>(bins) * beams, T(0.0));
  parallel_rows(bins, [&](int bin) {
    T* out = &image[static_cast<std::size_t>(bin) * beams];
    const int first_own = bin * kRangeSteps;
    const int end_own = first_own + kRangeSteps;
    const int first = std::max(0, first_own - reach_rows);
    const int end = std::min(histogram.rows, end_own + reach_rows);
    for (int row = first; row < end; row += group) {
      if (group_is_empty(row)) continue;
      const T* in = &spread[static_cast<std::size_t>(row) * beams];
      const double sigma_m = ScalarPart(sigma_range_m[row]);
      if (!(sigma_m > 0.0)) {
        if (row < first_own || row >= end_own) continue;
        for (int col = 0; col < beams; ++col) out[col] += in[col];
        continue;
      }
      const T weight =
          GaussianBlurWeight(row * step_m, (row + group) * step_m, bin * bin_m, (bin + 1) * bin_m, sigma_m)
              .At(sigma_range_m[row], sigma_m);
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
