// Divides plane polygons into triangles. Hand-written because the triangulators that exist (earcut, assimp)
// drop corners in line, which opens seams between faces, or divide some concave polygons wrongly.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

namespace sonarcal::data_io {

// Returns corners.size() - 2 triangles as indices of corners, with the orientation of the polygon. Uses ear
// clipping on the plane of the mean (Newell) normal. The polygon may be concave, have collinear or repeated
// corners, be slightly out of plane, and touch itself, as around a hole. Returns nothing if its sides cross.
// Time: the square of the number of corners, in the worst case the cube. Requires at least three corners
// (SONARCAL_CHECK).
std::optional<std::vector<std::array<int, 3>>> DividePolygon(std::span<const Eigen::Vector3d> corners);

}  // namespace sonarcal::data_io
