// Positions of the markers of a field, and one marker as seen in an image.
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
  double size_m = 0.0;  // side of the black square, with its border, without the white margin
  Pose world_from_marker;
};

// The four corners in the marker frame, metres.
inline std::array<Eigen::Vector3d, 4> MarkerCorners(double size_m) {
  const double h = 0.5 * size_m;
  return {{{-h, h, 0.0}, {h, h, 0.0}, {h, -h, 0.0}, {-h, -h, 0.0}}};
}

// Accuracy of the map: standard deviation per axis, independent for each marker.
struct MarkerMapSigma {
  double position_m = 0.0;
  double angle_rad = 0.0;
};

struct MarkerMap {
  std::string dictionary;       // OpenCV's name, e.g. "DICT_4X4_50"
  std::vector<Marker> markers;  // each id occurs once
  std::optional<MarkerMapSigma> sigma;

  const Marker* Find(int id) const {
    for (const Marker& marker : markers) {
      if (marker.id == id) return &marker;
    }
    return nullptr;
  }
};

// Marker found in an image: corners in pixels (core/types/camera.h), in the order above.
struct MarkerQuad {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners_px;
};

}  // namespace sonarcal
