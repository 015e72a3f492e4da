// Where the markers of a field are, and one marker as an image shows it.
//
// Marker frame: origin at the middle of the black square, X to the right and Y up as the marker is printed, Z
// out of its face. Corners in the order top left, top right, bottom right, bottom left of the print.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/types/pose.h"

namespace sonarcal {

struct Marker {
  int id = 0;
  double size_m = 0.0;  // side of the black square: border included, white margin not
  Pose world_from_marker;
};

// The four corners in the marker frame, metres.
inline std::array<Eigen::Vector3d, 4> MarkerCorners(double size_m) {
  const double h = 0.5 * size_m;
  return {{{-h, h, 0.0}, {h, h, 0.0}, {h, -h, 0.0}, {-h, -h, 0.0}}};
}

// How far markers may be from where the map has them: standard deviation an axis, each marker by itself.
struct MarkerMapSigma {
  double position_m = 0.0;
  double angle_rad = 0.0;
};

struct MarkerMap {
  std::string dictionary;       // "DICT_4X4_50", as OpenCV names them
  std::vector<Marker> markers;  // each id once
  std::optional<MarkerMapSigma> sigma;

  const Marker* Find(int id) const {
    for (const Marker& marker : markers) {
      if (marker.id == id) return &marker;
    }
    return nullptr;
  }
};

// A marker found in an image: corners in pixels (types/camera.h), in the order above.
struct MarkerQuad {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners_px;
};

}  // namespace sonarcal
