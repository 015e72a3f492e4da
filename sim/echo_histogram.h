// A frame's echoes, gathered by pixel: how many, how far, and at which incidence on which material. The rays
// of a pixel share its range, so a pixel of the paper's image is (affine in) the backscatter curve times such
// a histogram: millions of rays become a small sparse matrix that shades in milliseconds and casts no ray.
//
// Incidence is kept on a grid of kIncidenceNodes angles a quarter of a degree apart, each echo shared between
// the two nearest: a curve is then its values at the nodes, joined by straight lines (for B = 4 degrees that
// is within 0.003 dB of the curve; tests/sim/expected_paper_image_test.cc holds it against the rays
// themselves).
#pragma once

#include <cstdint>
#include <vector>

#include "sim/trace.h"

namespace sonarcal {

inline constexpr int kRangeSteps = 4;  // cells a range bin
inline constexpr int kIncidenceNodes = 361;
inline constexpr double kIncidenceStepDeg = 0.25;

struct EchoHistogram {
  // One cell that holds echoes; `row` counts quarters of range bins. Weights are the ray's share of its beam,
  // 1 / rays_per_beam.
  struct Cell {
    std::int32_t row = 0;
    std::int32_t col = 0;
    double weight = 0.0;           // sum of weights
    double log_range = 0.0;        // weighted sum of 40 log10 R, dB
    double two_way_range_m = 0.0;  // weighted sum of 2 R
    std::uint32_t first_entry = 0;
    std::uint32_t last_entry = 0;  // one past
  };
  struct Entry {
    std::uint32_t node = 0;  // material * kIncidenceNodes + node
    float weight = 0.0F;
  };

  int rows = 0;  // kRangeSteps x range bins
  int beams = 0;
  int materials = 0;
  std::vector<Cell> cells;               // by row, then column
  std::vector<std::uint32_t> row_start;  // first cell of each row, rows + 1 values
  std::vector<Entry> entries;
};

EchoHistogram GatherEchoes(const EchoList& echoes, const PolarAxes& axes);

}  // namespace sonarcal
