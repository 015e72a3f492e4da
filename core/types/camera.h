// Optical camera beside the sonar, and the flat port it may look through.
//
// Camera frame as in OpenCV: X right, Y down, Z forward, metres, origin at the centre of projection. Pixels:
// u to the right, v down, the centre of the top-left pixel at (0, 0). The formulas are in
// calib/markers/camera.h.
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/types/pose.h"

namespace sonarcal {

// Pinhole camera with OpenCV's polynomial distortion.
struct Camera {
  int cols = 0;  // image size, pixels
  int rows = 0;
  double fx_px = 0.0;
  double fy_px = 0.0;
  double cx_px = 0.0;
  double cy_px = 0.0;
  // k1, k2, p1, p2, k3, k4, k5, k6 (rational), s1, s2, s3, s4 (thin prism); 0 if the file does not give it.
  std::array<double, 12> distortion{};
};

// Flat window between air and water. The camera, in air, is `distance_m` from the inner face.
struct FlatPort {
  double distance_m = 0.0;   // from the centre of projection to the inner face, along the normal; >= 0
  double thickness_m = 0.0;  // thickness of the window; >= 0
  double glass_index = 1.49;
  double water_index = 1.333;                // refractive indices relative to air, 1 to 3
  Eigen::Vector3d normal = {0.0, 0.0, 1.0};  // into the water, camera frame, unit length

  // Distance from the centre of projection to the outer face, along the normal.
  double outer_m() const { return distance_m + thickness_m; }
};

// Mounting of the camera relative to the sonar.
struct CameraMount {
  Pose camera_from_sonar;
  // Standard deviation per axis of the mounting; 0: exact. Position along the camera's axes, angle about the
  // sonar's axes.
  double sigma_position_m = 0.0;
  double sigma_angle_rad = 0.0;
};

}  // namespace sonarcal
