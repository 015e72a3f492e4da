// An optical camera beside the sonar, and the flat window it may look through.
//
// Camera frame as OpenCV's: X right, Y down, Z ahead, metres, origin at the centre of projection. Pixels: u
// to the right, v down, the centre of the top-left pixel at (0, 0). The formulas are in
// calib/markers/camera.h.
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/types/pose.h"

namespace sonarcal {

// Pinhole with OpenCV's polynomial distortion.
struct Camera {
  int cols = 0;  // of its images, pixels
  int rows = 0;
  double fx_px = 0.0;
  double fy_px = 0.0;
  double cx_px = 0.0;
  double cy_px = 0.0;
  // k1, k2, p1, p2, k3, k4, k5, k6 (rational), s1, s2, s3, s4 (thin prism); 0 for what a file does not give.
  std::array<double, 12> distortion{};
};

// A flat window between air and water. The camera, in air, stands `distance_m` from the inner face.
struct FlatPort {
  double distance_m = 0.0;   // from the centre of projection to the inner face, along the normal; >= 0
  double thickness_m = 0.0;  // of the window; >= 0
  double glass_index = 1.49;
  double water_index = 1.333;                // refractive indices relative to air, 1 to 3
  Eigen::Vector3d normal = {0.0, 0.0, 1.0};  // into the water, camera frame, unit length

  // Of the outer face, from the centre of projection, along the normal.
  double outer_m() const { return distance_m + thickness_m; }
};

// How the camera sits beside the sonar.
struct CameraMount {
  Pose camera_from_sonar;
  // Standard deviation an axis of what is left to doubt; 0: taken for exact. Position along the camera's
  // axes, angle about the sonar's.
  double sigma_position_m = 0.0;
  double sigma_angle_rad = 0.0;
};

}  // namespace sonarcal
