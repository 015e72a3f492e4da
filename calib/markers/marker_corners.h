// Corners of a marker, from straight lines fitted to the four edges of its black square.
//
// A corner itself is a poor mark: blur rounds it, and an estimator that looks there is off by a tenth of a
// pixel, always outwards or always inwards. An edge stays where it is under any symmetric blur. So each edge
// is sampled every pixel along it, between the corners' surroundings; across it, over +-h,
//
//   offset = (h (I(h) + I(-h)) - integral of I) / (mean of I(h) - I(-h) over the edge),
//
// exact for grey that is a pixel's mean and interpolated linearly, and again after the window was centred.
// Samples go through the camera (and port) into coordinates in which straight lines are straight
// (calib/markers/camera.h); a line by least squares, without samples beyond 3.5 deviations; neighbouring
// lines meet in the corners; the corners go back to pixels.
//
// The covariance of the corners comes from the scatter of the samples about their lines, of all four edges
// together, and holds how the corners of a marker hang together. Samples next to each other share pixels: it
// is right up to a factor that all markers share (calib/markers/marker_poses.h finds it). Edges that glare
// moves are not noticed.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "core/types/camera.h"
#include "core/types/image.h"
#include "core/types/marker_map.h"

namespace sonarcal::calib {

using Matrix8d = Eigen::Matrix<double, 8, 8>;

struct MarkerObservation {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners_px;
  Matrix8d covariance_px2;  // of u0, v0, u1, v1, ..., up to a factor common to all
};

struct MarkerShape {
  int cells = 0;        // along a side, border included
  double size_m = 0.0;  // matters behind a port alone
};

// Nothing where the marker is too small (edges shorter than about 10 pixels), out of the image in part, of
// too little contrast, or where its edges are not straight to within a pixel.
std::optional<MarkerObservation> RefineMarkerCorners(const Grid<std::uint8_t>& grey, const MarkerQuad& quad,
                                                     const MarkerShape& shape, const Camera& camera,
                                                     const FlatPort* port);

// Roughly how far ahead of the camera a marker is, from its longest side.
double MarkerDepthM(const MarkerQuad& quad, double size_m, const Camera& camera, const FlatPort* port);

}  // namespace sonarcal::calib
