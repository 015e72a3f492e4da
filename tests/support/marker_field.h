// A field of markers and pictures of it, rendered by ray: a second implementation of the camera that shares
// no formula with the code under test. For each of n x n rays a pixel it undoes the distortion by fixed-point
// iteration, bends the ray at both faces of the port by the vector form of Snell's law, meets the planes of
// the markers, and looks the cell up. Then Gaussian blur (a lens's), occluders, and white noise. SYNTHETIC.
//
// The camera looks down on a floor at z = 0 whose markers are a jittered grid, turned every which way; some
// may stand higher or be tilted.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "core/types/camera.h"
#include "core/types/image.h"
#include "core/types/marker_map.h"

namespace sonarcal::testing {

struct FieldOptions {
  std::string dictionary = "DICT_4X4_50";
  int rows = 4;
  int cols = 5;
  double spacing_m = 0.3;
  double size_m = 0.15;
  bool flat = true;  // otherwise heights up to 0.2 m and tilts up to 20 degrees
  unsigned seed = 1;
};

// Centred at the world's origin, ids from 0.
MarkerMap MarkerField(const FieldOptions& options = {});

// 640 x 480, about 60 degrees wide, with a barrel distortion in all five numbers.
Camera FieldCamera();

// Above the field, looking at a point of it: `height_m` up, `aside_m` off (x, y), turned by `spin_rad`.
Pose LookingDown(double height_m, const Eigen::Vector2d& aside_m, const Eigen::Vector2d& target_m,
                 double spin_rad);

struct PictureOptions {
  double blur_px = 0.7;  // standard deviation
  double noise_grey = 3.0;
  int occluders = 0;  // discs of mid grey, of 15 to 40 pixels
  unsigned seed = 1;
};

class FieldRenderer {
 public:
  // `port` null: none.
  FieldRenderer(const MarkerMap& map, const Camera& camera, const FlatPort* port, int supersampling = 4);

  Grid<std::uint8_t> Render(const Pose& world_from_camera, const PictureOptions& options) const;

 private:
  struct Ray {
    Eigen::Vector3d origin;
    Eigen::Vector3d direction;
  };
  struct Sheet {
    Pose marker_from_world;
    double size_m = 0.0;
    Grid<std::uint8_t> cells;  // of the print, row 0 on top; 0 black
  };
  struct PlacedSheet {  // sheet_from_camera
    const Sheet* sheet = nullptr;
    Eigen::Matrix3d rotation;
    Eigen::Vector3d position_m;
  };
  struct Meeting {
    double distance = -1.0;
    double x = 0.0;
    double y = 0.0;
  };
  static Meeting Meet(const Ray& ray, const PlacedSheet& sheet);
  static double GreyAlong(const Ray& ray, const std::vector<PlacedSheet>& sheets);
  std::vector<PlacedSheet> SheetsOfTile(const std::vector<PlacedSheet>& sheets, int row, int col,
                                        int size) const;

  Camera camera_;
  int supersampling_;
  std::vector<Ray> rays_;  // in the camera's frame
  std::vector<Sheet> sheets_;
};

}  // namespace sonarcal::testing
