// Echoes of each pixel of the paper's image through fixed range and azimuth errors:
// sim/paper/echo_histogram.h after sim/paper/paper_blur.h. Before the clamp, a pixel is then a short sum over
// incidence nodes,
//
//   sum(r, b) = (sum over entries of weight x (S + TS_material(incidence)) - loss) / span,
//   S = SL - NL + AG - dB_min,
//
// so a fit of backscatter curves and display needs no blur. sim/paper/expected_paper_image.h computes the
// same cell by cell. Nodes are those of PixelEchoes. Interpolation is linear in dB; its errors up to 80
// degrees:
//
//   the paper's own curve                                   0.02 dB
//   Gaussian of B = 3 degrees, 20 dB above a cosine         0.03 dB
//   Gaussian of B = 1 degree, 30 dB above a cosine          0.4 dB
//   cosine of exponent 2 (0.18 dB from 80 to 86 degrees)    0.04 dB
#pragma once

#include <vector>

#include "core/types/parameters.h"
#include "sim/gathered/pixel_echoes.h"
#include "sim/paper/echo_histogram.h"
#include "sim/paper/image_geometry.h"

namespace sonarcal::sim {

struct PaperEchoes {
  PixelEchoes nodes;           // weights: shares of the rays of a beam
  std::vector<float> loss_db;  // per pixel: sum of weight x two-way loss
};

PaperEchoes GatherPaperEchoes(const EchoHistogram& histogram, const ImageGeometry& geometry,
                              const JitterParameters<double>& errors);

// Angle at which a curve in dB is evaluated for a coarse node. As IncidenceOfNodeDeg, the last one gives the
// last interval its mean level.
double PaperIncidenceDeg(std::size_t node);

}  // namespace sonarcal::sim
