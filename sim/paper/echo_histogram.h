// Echoes of a frame, gathered by pixel: their number, range, and incidence on each material. The rays of a
// pixel share its range. A pixel of the paper's image is therefore an affine function of the backscatter
// curve times such a histogram. Millions of rays become a small sparse matrix that shades in milliseconds
// without casting a ray.
//
// Incidence is kept on a grid of kIncidenceNodes angles, a quarter of a degree apart. Each echo is shared
// between the two nearest nodes, so a curve is piecewise linear between its values at the nodes. For B = 4
// degrees the error is below 0.003 dB up to 86 degrees and below 0.04 dB up to 89. At 90 degrees the level of
// the cosine has no lower bound; IncidenceOfNodeDeg gives the last node a finite value.
// tests/sim/paper/expected_paper_image_test.cc compares the image with the rays themselves.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/rays/trace.h"

namespace sonarcal::sim {

inline constexpr int kRangeSteps = 2;  // cells per range bin
inline constexpr int kIncidenceNodes = 361;
inline constexpr double kIncidenceStepDeg = 0.25;

// Angle at which a curve is evaluated for the end of the interval from `start_deg` to 90 degrees. Over it,
// the level of cos(delta) lies on average one neper of power below its value at the start. A straight line
// has that average if it ends two nepers down, where the cosine is e^-2 of its value at the start.
inline double GrazingEndDeg(double start_deg) {
  constexpr double kTwoNepers = 0.1353352832366127;  // e^-2
  return 90.0 - (90.0 - start_deg) * kTwoNepers;
}

// Angle at which a curve is evaluated for a node.
inline double IncidenceOfNodeDeg(int node) {
  return node + 1 < kIncidenceNodes ? node * kIncidenceStepDeg : GrazingEndDeg(90.0 - kIncidenceStepDeg);
}

struct EchoHistogram {
  // One cell that holds echoes; `row` counts half range bins. Weights are the rays' shares of their beam,
  // EchoList::Weight / rays_per_beam.
  struct Cell {
    std::int32_t row = 0;
    std::int32_t col = 0;
    double weight = 0.0;           // sum of weights
    double log_range = 0.0;        // weighted sum of 40 log10 R, dB
    double two_way_range_m = 0.0;  // weighted sum of 2 R
    // Mean position of the echoes in the cell, -1/2 .. 1/2 of its height and of its beam's width.
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

// GatherEchoes(Trace(...)) with normals of the mesh, at a lower cost: rows of rays are handled in single
// precision, many at a time, and nothing is computed that the histogram does not keep.
EchoHistogram CastEchoHistogram(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                                const PolarAxes& axes);

}  // namespace sonarcal::sim
