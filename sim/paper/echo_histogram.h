// A frame's echoes, gathered by pixel: how many, how far, and at which incidence on which material. The rays
// of a pixel share its range, so a pixel of the paper's image is (affine in) the backscatter curve times such
// a histogram: millions of rays become a small sparse matrix that shades in milliseconds and casts no ray.
//
// Incidence is kept on a grid of kIncidenceNodes angles a quarter of a degree apart, each echo shared between
// the two nearest: a curve is then its values at the nodes, joined by straight lines. For B = 4 degrees that
// is within 0.003 dB of the curve up to 86 degrees, and within 0.04 dB to 89; at 90 degrees the level of the
// cosine has no bottom, and the last node stands for the last interval as IncidenceOfNodeDeg says.
// tests/sim/paper/expected_paper_image_test.cc holds the image against the rays themselves.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/rays/trace.h"

namespace sonarcal::sim {

inline constexpr int kRangeSteps = 2;  // cells a range bin
inline constexpr int kIncidenceNodes = 361;
inline constexpr double kIncidenceStepDeg = 0.25;

// Where a curve is read for a node: at the node, but for the last one. The level of cos(delta) falls over the
// last interval by one neper of power, on average, below its value at the interval's start; a straight line
// has that average if it ends two nepers down, where the cosine is e^-2 of what it was.
inline double IncidenceOfNodeDeg(int node) {
  constexpr double kLastDeg = 90.0 - kIncidenceStepDeg * 0.1353352832366127;  // e^-2
  return node + 1 < kIncidenceNodes ? node * kIncidenceStepDeg : kLastDeg;
}

struct EchoHistogram {
  // One cell that holds echoes; `row` counts halves of range bins. Weights are the rays' shares of their
  // beam, EchoList::Weight / rays_per_beam.
  struct Cell {
    std::int32_t row = 0;
    std::int32_t col = 0;
    double weight = 0.0;           // sum of weights
    double log_range = 0.0;        // weighted sum of 40 log10 R, dB
    double two_way_range_m = 0.0;  // weighted sum of 2 R
    // Where in the cell its echoes are on average, -1/2 .. 1/2 of its height and of its beam's width.
    float range_offset = 0.0F;
    float azimuth_offset = 0.0F;
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

}  // namespace sonarcal::sim
