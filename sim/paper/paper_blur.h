// Gaussian range and azimuth errors of the paper's rays, as they act on an expected image: a linear map from
// the cells of an EchoHistogram to pixels, and its derivatives with respect to the sizes of the errors.
//
// The echoes of a cell are spread evenly over its lower and upper half, and over the two halves of its beam.
// The shares of the halves reproduce the mean position, which is correct to first order in the cell's size.
// Without errors the image is sharp.
//
// The map is linear, so it serves an image and each of its derivatives, in plain numbers. Functions of
// parameters act on one cell at a time (sim/paper/expected_paper_image.h); this file handles neighbouring
// cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sim/paper/echo_histogram.h"
#include "sim/paper/image_geometry.h"
#include "sim/physics/jitter.h"

namespace sonarcal::sim {

class PaperBlur {
 public:
  // Standard deviations of a ray's errors for each row of cells; 0 for none. Histogram and geometry must
  // outlive the blur.
  PaperBlur(const EchoHistogram& histogram, const ImageGeometry& geometry,
            std::span<const double> sigma_range_m, std::span<const double> sigma_azimuth_rad);

  // Cells after the blur in azimuth: rows of cells (or of whole bins, if range errors are wide) x beams.
  struct Rows {
    std::unique_ptr<double[]> values;
    std::unique_ptr<double[]> moments;  // as `values`, each cell times its offset in range
    // Beams [first, last) that hold data; all others are not initialised and not read.
    std::vector<std::int32_t> first;
    std::vector<std::int32_t> last;
  };

  // `cells` holds one value for each cell of the histogram.
  Rows AlongAzimuth(std::span<const double> cells) const;

  // Adds the change of AlongAzimuth(cells) when the azimuth errors of each row of cells grow by `growth_rad`.
  void AddAzimuthGrowth(std::span<const double> cells, std::span<const double> growth_rad, Rows& rows) const;

  // Image of range bins x beams.
  std::vector<double> AlongRange(const Rows& rows) const;

  // Adds to `image` the change of AlongRange(rows) when the range errors of each row of cells grow by
  // `growth_m`.
  void AddRangeGrowth(const Rows& rows, std::span<const double> growth_m, std::vector<double>& image) const;

  // Single weights, for sums other than an image.
  struct RangeWeight {
    std::int32_t row = 0;  // row of Rows
    BlurWeight weight;
    BlurWeight moment;
  };
  struct BeamWeights {
    int first = 0;  // beam
    std::vector<float> weight;
  };
  int row_count() const { return histogram_.rows / group_; }
  // Cells [first, last) of a row of Rows.
  std::pair<std::uint32_t, std::uint32_t> CellsOfRow(int row) const {
    return {histogram_.row_start[row * group_], histogram_.row_start[(row + 1) * group_]};
  }
  // Weights of a cell in the beams.
  void WeighBeams(const EchoHistogram::Cell& cell, BeamWeights& beams) const;
  // Offset of a cell in range within its row of Rows.
  double RangeOffset(const EchoHistogram::Cell& cell) const {
    return (cell.row % group_ + 0.5 + cell.range_offset) / group_ - 0.5;
  }
  // Weights of the rows that reach a bin. The moment multiplies the offset of a cell.
  std::span<const RangeWeight> RowsOfBin(int bin) const {
    return std::span(range_weights_).subspan(range_start_[bin], range_start_[bin + 1] - range_start_[bin]);
  }

 private:
  // Weights from every beam to its neighbours, for errors of nearly one size.
  struct AzimuthKernel {
    double sigma_rad = 0.0;
    std::vector<std::int32_t> first;  // target beams [first, last) of each beam
    std::vector<std::int32_t> last;
    std::vector<std::ptrdiff_t> start;  // start of a beam's weights, minus its first target
    std::vector<double> value;
    std::vector<double> slope;   // d value / d sigma
    std::vector<double> moment;  // derivative of the value by the offset in units of the beam's width
    std::vector<double> moment_slope;
  };

  AzimuthKernel MakeAzimuthKernel(double sigma_rad) const;
  void MakeAzimuthKernels();
  void MakeRangeWeights();
  std::pair<int, int> TouchedBeams(std::span<const double> cells, int out_row) const;
  static void Widen(Rows& rows, int out_row, int beams, std::pair<int, int> touched);
  template <typename WeightOf>
  void Spread(std::span<const double> cells, Rows& rows, WeightOf weight_of) const;
  // Value at the middle of a row, interpolated between the values of its rows of cells.
  double AtMiddle(std::span<const double> of_rows_of_cells, int row) const;
  int beams() const { return histogram_.beams; }

  const EchoHistogram& histogram_;
  const ImageGeometry& geometry_;
  std::vector<double> sigma_range_m_;
  std::vector<double> sigma_azimuth_rad_;
  int group_ = 1;  // number of rows of cells that are blurred together along range
  std::vector<AzimuthKernel> kernels_;
  std::vector<int> kernel_of_row_;          // -1: no errors
  std::vector<RangeWeight> range_weights_;  // per bin
  std::vector<std::size_t> range_start_;    // first weight of each bin, bins + 1 values
};

}  // namespace sonarcal::sim
