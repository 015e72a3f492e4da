// The Gaussian range and azimuth errors of the paper's rays, as what they are to a mean image: a linear map
// from the cells of an EchoHistogram to pixels, and its derivatives with respect to the errors' sizes.
//
// A cell's echoes are taken to be spread evenly over its lower and upper half, and over the two halves of its
// beam, in such shares that their mean is where it is: right to first order in the size of a cell. Sharp
// where there are no errors.
//
// Being linear it serves an image and each of the image's derivatives alike, in plain numbers: what depends
// on a parameter goes through one cell at a time (sim/paper/expected_paper_image.h), what depends on
// neighbours is here.
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

  // Cells spread over the beams: rows of cells (or of whole bins, where range errors are wide) x beams.
  struct Rows {
    std::unique_ptr<double[]> values;
    std::unique_ptr<double[]> moments;  // the same of each cell times its offset in range
    // Beams [first, last) that hold anything; the rest is not set and never looked at.
    std::vector<std::int32_t> first;
    std::vector<std::int32_t> last;
  };

  // `cells` holds a value for each cell of the histogram.
  Rows AlongAzimuth(std::span<const double> cells) const;

  // Adds what `cells` change when the azimuth errors of each row of cells grow by `growth_rad`.
  void AddAzimuthGrowth(std::span<const double> cells, std::span<const double> growth_rad, Rows& rows) const;

  // Range bins x beams.
  std::vector<double> AlongRange(const Rows& rows) const;

  // Adds to `image` what `rows` change when the range errors of each row of cells grow by `growth_m`.
  void AddRangeGrowth(const Rows& rows, std::span<const double> growth_m, std::vector<double>& image) const;

 private:
  // Weights from every beam to its neighbours, for errors of about one size.
  struct AzimuthKernel {
    double sigma_rad = 0.0;
    std::vector<std::int32_t> first;  // target beams [first, last) of each beam
    std::vector<std::int32_t> last;
    std::vector<std::ptrdiff_t> start;  // of a beam's weights, less its first target
    std::vector<double> value;
    std::vector<double> slope;   // d value / d sigma
    std::vector<double> moment;  // what an offset of the whole beam would add to it
    std::vector<double> moment_slope;
  };
  struct RangeWeight {
    std::int32_t row = 0;  // of Rows
    BlurWeight weight;
    BlurWeight moment;
  };

  AzimuthKernel MakeAzimuthKernel(double sigma_rad) const;
  void MakeAzimuthKernels();
  void MakeRangeWeights();
  std::pair<int, int> TouchedBeams(std::span<const double> cells, int out_row) const;
  static void Widen(Rows& rows, int out_row, int beams, std::pair<int, int> touched);
  template <typename WeightOf>
  void Spread(std::span<const double> cells, Rows& rows, WeightOf weight_of) const;
  // The value at the middle of a row, between those of the rows of cells that make it up.
  // Offset of a cell in range within its row.
  double RangeOffset(const EchoHistogram::Cell& cell) const {
    return (cell.row % group_ + 0.5 + cell.range_offset) / group_ - 0.5;
  }
  double AtMiddle(std::span<const double> of_rows_of_cells, int row) const;
  int row_count() const { return histogram_.rows / group_; }
  int beams() const { return histogram_.beams; }

  const EchoHistogram& histogram_;
  const ImageGeometry& geometry_;
  std::vector<double> sigma_range_m_;
  std::vector<double> sigma_azimuth_rad_;
  int group_ = 1;  // rows of cells that are blurred along range as one
  std::vector<AzimuthKernel> kernels_;
  std::vector<int> kernel_of_row_;          // -1: no errors
  std::vector<RangeWeight> range_weights_;  // by bin
  std::vector<std::size_t> range_start_;    // first weight of each bin, bins + 1 values
};

}  // namespace sonarcal::sim
