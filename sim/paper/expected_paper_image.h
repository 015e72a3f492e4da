// Expected image of the paper's model: the mean over its range and azimuth errors, computed from an
// EchoHistogram. This forward model renders images, and Ceres differentiates it.
//
// The echoes of each cell are spread over the cell about their mean position, then over neighbouring cells by
// the Gaussian errors at the cell's range (sim/physics/jitter.h, sim/paper/paper_blur.h). Without errors the
// image is sharp. The clamp to [0, I] applies to the mean, as if the many rays of a pixel had averaged out.
//
// Derivatives come from the same formulas with dual numbers as scalars, cell by cell. The blur is linear, so
// it applies to each derivative as it applies to the image.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "sim/paper/echo_histogram.h"
#include "sim/paper/image_geometry.h"
#include "sim/paper/paper_blur.h"
#include "sim/physics/jitter.h"
#include "sim/physics/paper_echo.h"

namespace sonarcal::sim {
namespace internal {

// Sum of normalised echoes of each cell, without errors.
template <typename T>
std::vector<T> ShadeCells(const EchoHistogram& histogram, const ImageGeometry& geometry,
                          const PaperParameters<T>& parameters) {
  std::vector<T> strength_db(static_cast<std::size_t>(histogram.materials) * kIncidenceNodes);
  for (int material = 0; material < histogram.materials; ++material) {
    for (int node = 0; node < kIncidenceNodes; ++node) {
      strength_db[static_cast<std::size_t>(material) * kIncidenceNodes + node] =
          GsabDb(parameters.materials[material], IncidenceOfNodeDeg(node));
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

// Values of parameters that are dual numbers.
template <typename Dual>
PaperParameters<double> ValuesOf(const PaperParameters<Dual>& p) {
  PaperParameters<double> values;
  values.source_level_db = p.source_level_db.a;
  values.display = {p.display.db_min.a, p.display.db_max.a};
  for (const GsabParameters<Dual>& g : p.materials) {
    values.materials.push_back({g.a.a, g.b_deg.a, g.c.a, g.d.a, g.e.a, g.f_deg.a});
  }
  values.jitter = {p.jitter.sigma_range_m.a, p.jitter.sigma_azimuth_deg.a, p.jitter.reference_range_m.a,
                   p.jitter.reference_frequency_hz, p.jitter.growth};
  values.noise_level_db = p.noise_level_db;
  values.array_gain_db = p.array_gain_db;
  return values;
}

// Derivatives of dual numbers, one list per parameter.
template <typename Dual>
std::vector<std::vector<double>> PartsOf(const std::vector<Dual>& duals) {
  std::vector<std::vector<double>> parts(Dual::DIMENSION, std::vector<double>(duals.size()));
  for (std::size_t i = 0; i < duals.size(); ++i) {
    for (int k = 0; k < static_cast<int>(Dual::DIMENSION); ++k) parts[k][i] = duals[i].v[k];
  }
  return parts;
}

// Range and azimuth errors of each row of cells.
template <typename T>
struct RowErrors {
  std::vector<T> sigma_range_m;
  std::vector<T> sigma_azimuth_rad;
};

template <typename T>
RowErrors<T> ErrorsOfRows(const EchoHistogram& histogram, const ImageGeometry& geometry,
                          const JitterParameters<T>& jitter) {
  const double step_m = geometry.axes.range_bin_m() / kRangeSteps;
  RowErrors<T> errors;
  for (int row = 0; row < histogram.rows; ++row) {
    const double range_m = geometry.axes.range_min_m + (row + 0.5) * step_m;
    errors.sigma_range_m.push_back(JitterSigmaRangeM(jitter, range_m, geometry.frequency_hz));
    errors.sigma_azimuth_rad.push_back(JitterSigmaAzimuthRad(jitter, range_m, geometry.frequency_hz));
  }
  return errors;
}

}  // namespace internal

// Image at one set of parameters, with the data that its derivatives need. Histogram and geometry must
// outlive it.
class PaperImageEvaluation {
 public:
  PaperImageEvaluation(const EchoHistogram& histogram, const ImageGeometry& geometry,
                       const PaperParameters<double>& parameters)
      : PaperImageEvaluation(histogram, geometry, parameters,
                             internal::ErrorsOfRows(histogram, geometry, parameters.jitter)) {}

  // Sums of normalised echoes before the clamp to 0..1, row-major (range_bins x beams).
  const std::vector<double>& sums() const { return sums_; }

  // Derivatives of the sums, one image per derivative that `parameters` carries. `Dual` has a value `a` and
  // derivatives `v[0 .. DIMENSION)`, as ceres::Jet; its values must equal the parameters of this image.
  template <typename Dual>
  std::vector<std::vector<double>> Derivatives(const PaperParameters<Dual>& parameters) const;

 private:
  PaperImageEvaluation(const EchoHistogram& histogram, const ImageGeometry& geometry,
                       const PaperParameters<double>& parameters, const internal::RowErrors<double>& errors)
      : histogram_(histogram),
        geometry_(geometry),
        blur_(histogram, geometry, errors.sigma_range_m, errors.sigma_azimuth_rad),
        cells_(internal::ShadeCells(histogram, geometry, parameters)),
        rows_(blur_.AlongAzimuth(cells_)),
        sums_(blur_.AlongRange(rows_)) {}

  const EchoHistogram& histogram_;
  const ImageGeometry& geometry_;
  PaperBlur blur_;
  std::vector<double> cells_;
  PaperBlur::Rows rows_;
  std::vector<double> sums_;
};

template <typename Dual>
std::vector<std::vector<double>> PaperImageEvaluation::Derivatives(
    const PaperParameters<Dual>& parameters) const {
  const std::vector<Dual> cells = internal::ShadeCells(histogram_, geometry_, parameters);
  const internal::RowErrors<Dual> errors = internal::ErrorsOfRows(histogram_, geometry_, parameters.jitter);
  const auto cell_parts = internal::PartsOf(cells);
  const auto range_growth_m = internal::PartsOf(errors.sigma_range_m);
  const auto azimuth_growth_rad = internal::PartsOf(errors.sigma_azimuth_rad);
  const auto any = [](const std::vector<double>& values) {
    return std::any_of(values.begin(), values.end(), [](double value) { return value != 0.0; });
  };
  std::vector<std::vector<double>> derivatives(Dual::DIMENSION);
  tbb::parallel_for(0, static_cast<int>(Dual::DIMENSION), [&](int k) {
    PaperBlur::Rows rows = blur_.AlongAzimuth(cell_parts[k]);
    if (any(azimuth_growth_rad[k])) blur_.AddAzimuthGrowth(cells_, azimuth_growth_rad[k], rows);
    std::vector<double> derivative = blur_.AlongRange(rows);
    if (any(range_growth_m[k])) blur_.AddRangeGrowth(rows_, range_growth_m[k], derivative);
    derivatives[k] = std::move(derivative);
  });
  return derivatives;
}

// Expected image in units of full scale, 0..1, row-major (range_bins x beams).
inline std::vector<double> ExpectedPaperImage(const EchoHistogram& histogram, const ImageGeometry& geometry,
                                              const PaperParameters<double>& parameters) {
  std::vector<double> image = PaperImageEvaluation(histogram, geometry, parameters).sums();
  for (double& pixel : image) pixel = std::clamp(pixel, 0.0, 1.0);
  return image;
}

// Expected image in dual numbers, as in PaperImageEvaluation::Derivatives. Derivatives are 0 where the image
// is clamped.
template <typename Dual>
std::vector<Dual> ExpectedPaperImage(const EchoHistogram& histogram, const ImageGeometry& geometry,
                                     const PaperParameters<Dual>& parameters) {
  const PaperImageEvaluation evaluation(histogram, geometry, internal::ValuesOf(parameters));
  const std::vector<std::vector<double>> derivatives = evaluation.Derivatives(parameters);
  std::vector<Dual> image;
  image.reserve(evaluation.sums().size());
  for (std::size_t i = 0; i < evaluation.sums().size(); ++i) {
    const double sum = evaluation.sums()[i];
    image.emplace_back(std::clamp(sum, 0.0, 1.0));
    if (sum < 0.0 || sum > 1.0) continue;
    for (int k = 0; k < static_cast<int>(Dual::DIMENSION); ++k) image[i].v[k] = derivatives[k][i];
  }
  return image;
}

}  // namespace sonarcal::sim
