// Plane polygons divided into triangles.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

namespace sonarcal::data_io {

// The corners.size() - 2 triangles of a polygon, by the places of its corners, each turning the way the
// polygon does: by ear clipping on the plane of the mean (Newell) normal. The polygon may be hollow, have
// corners in line or twice, be slightly out of plane, and touch itself, as one around a hole does; where no
// division is found, as its sides cross, nothing. Takes the square of the number of corners, at worst the
// cube. Three corners at least: a programmer's mistake otherwise.
std::optional<std::vector<std::array<int, 3>>> DividePolygon(std::span<const Eigen::Vector3d> corners);

}  // namespace sonarcal::data_io
