// Corners of a marker, from straight lines fitted to the four edges of its black square.
//
// A corner itself is hard to locate: blur rounds it, and an estimator at the corner is off by a tenth of a
// pixel, always outwards or always inwards. An edge keeps its place under any symmetric blur. So each edge is
// sampled at every pixel along it, except near the corners. Across it, over +-h, the offset is
//
//   offset = (h (I(h) + I(-h)) - integral of I) / (mean of I(h) - I(-h) over the edge).
//
// This is exact for grey that is the mean of a pixel and is interpolated linearly. It is repeated after the
// window is centred. The samples are transformed through the camera (and port) into coordinates in which
// straight lines are straight (calib/markers/camera.h). A line is fitted by least squares, without samples
// beyond 3.5 standard deviations. Neighbouring lines intersect in the corners, which are transformed back to
// pixels.
//
// The covariance of the corners comes from the scatter of the samples about their lines, of all four edges
// together, and includes the correlation of the corners of a marker. Neighbouring samples share pixels, so
// the covariance is right up to a factor common to all markers (calib/markers/marker_poses.h finds it).
// Limit: edges displaced by glare are not detected.
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
  Matrix8d covariance_px2;  // of u0, v0, u1, v1, ..., up to a common factor
};

struct MarkerShape {
  int cells = 0;        // along a side, including the border
  double size_m = 0.0;  // used only behind a port
};

// Nullopt if the marker is too small (edges shorter than about 10 pixels), partly outside the image or of too
// little contrast, or if its edges are not straight to within a pixel.
std::optional<MarkerObservation> RefineMarkerCorners(const Grid<std::uint8_t>& grey, const MarkerQuad& quad,
                                                     const MarkerShape& shape, const Camera& camera,
                                                     const FlatPort* port);

// Approximate distance of a marker ahead of the camera, from its longest side.
double MarkerDepthM(const MarkerQuad& quad, double size_m, const Camera& camera, const FlatPort* port);

}  // namespace sonarcal::calib
