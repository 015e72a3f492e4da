// Files about an optical camera.
//
// Camera: a YAML or XML file as written by OpenCV's calibration (cv::FileStorage), or ROS's camera_info:
//
//   image_width: 1280                      # both sizes are required; pixels
//   image_height: 960
//   camera_matrix: !!opencv-matrix         # 3 x 3: fx 0 cx, 0 fy cy, 0 0 1, pixels
//      rows: 3
//      cols: 3
//      dt: d
//      data: [ 1.05e+03, 0., 640., 0., 1.05e+03, 480., 0., 0., 1. ]
//   distortion_coefficients: !!opencv-matrix   # k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4]]]; absent: none
//      ...
//
// Other keys are ignored. Rejected: skew, fisheye and tilted-sensor models, files over 1 MB, and non-finite
// numbers.
//
// Port, JSON: lengths in metres, indices relative to air, normal (default: the optical axis) in camera axes:
//
//   {"format": "sonar-port/1", "distance_m": 0.02, "thickness_m": 0.008, "glass_index": 1.49,
//    "water_index": 1.333, "normal": [0, 0, 1]}
//
// Mount, JSON: converts sonar coordinates to camera coordinates; sigmas are standard deviations per axis.
//
//   {"format": "sonar-mount/1",
//    "camera_from_sonar": {"position_m": [x, y, z], "quaternion_wxyz": [w, x, y, z]},
//    "sigma": {"position_m": 0.002, "angle_deg": 0.2}}
//
// All functions throw DataError with file, line and key.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/types/camera.h"

namespace sonarcal::data_io {

Camera ReadCamera(const std::filesystem::path& file);
Camera CameraFromText(std::string_view text, const std::string& file);

FlatPort ReadFlatPort(const std::filesystem::path& file);

CameraMount ReadCameraMount(const std::filesystem::path& file);

}  // namespace sonarcal::data_io
