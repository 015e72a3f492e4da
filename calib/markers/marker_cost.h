// Residual of one marker in one image, for Ceres: its four projected corners minus the measured ones,
// whitened by the covariance of calib/markers/marker_corners.h. Eight numbers.
//
// Parameters are relative to a reference that is stored beside them, so that they stay near 0:
//
//   frame[6]   position of the camera in the world (metres, absolute), then the rotation vector w about the
//              camera's axes: world_from_camera = (position, reference * Exp(w))
//   marker[6]  step of the marker along world axes, metres, then a rotation vector about the marker's axes
//   focal[1]   factor of both focal lengths
#pragma once

#include <ceres/rotation.h>

#include <Eigen/Core>
#include <array>

#include "calib/markers/camera.h"
#include "calib/markers/marker_corners.h"

namespace sonarcal::calib {

// Cost of one marker of the map in one image.
struct MarkerCost {
  const Camera* camera = nullptr;
  const FlatPort* port = nullptr;  // null: none
  Marker marker;
  const Eigen::Quaterniond* world_from_camera_reference = nullptr;
  std::array<Eigen::Vector2d, 4> corners_px;
  Matrix8d whiten;  // residual = whiten (projected - measured)

  // Projects the corners to pixels. Returns false if one is not visible.
  template <typename T>
  bool Project(const T* frame, const T* step, const T* focal, Eigen::Matrix<T, 8, 1>& pixels) const {
    using Vector3 = Eigen::Matrix<T, 3, 1>;
    const Eigen::Quaternion<T> reference = world_from_camera_reference->cast<T>();
    const Eigen::Quaternion<T> printed = marker.world_from_marker.rotation.cast<T>();
    const std::array<Eigen::Vector3d, 4> corners_m = MarkerCorners(marker.size_m);
    for (int k = 0; k < 4; ++k) {
      const Vector3 corner = corners_m[k].cast<T>();
      Vector3 turned;
      ceres::AngleAxisRotatePoint(step + 3, corner.data(), turned.data());
      const Vector3 in_world = printed * turned + marker.world_from_marker.position_m.cast<T>() +
                               Eigen::Map<const Vector3>(step) - Eigen::Map<const Vector3>(frame);
      const Vector3 in_reference = reference.conjugate() * in_world;
      const T back[3] = {-frame[3], -frame[4], -frame[5]};
      Vector3 in_camera;
      ceres::AngleAxisRotatePoint(back, in_reference.data(), in_camera.data());
      Eigen::Matrix<T, 2, 1> pixel;
      if (!PixelOfPoint(*camera, port, *focal, in_camera, pixel)) return false;
      pixels.template segment<2>(2 * k) = pixel;
    }
    return true;
  }

  template <typename T>
  bool operator()(const T* frame, const T* step, const T* focal, T* residual) const {
    Eigen::Matrix<T, 8, 1> pixels;
    if (!Project(frame, step, focal, pixels)) return false;
    for (int k = 0; k < 4; ++k) {
      pixels(2 * k) -= corners_px[k].x();
      pixels(2 * k + 1) -= corners_px[k].y();
    }
    Eigen::Map<Eigen::Matrix<T, 8, 1>> result(residual);
    result = whiten.cast<T>() * pixels;
    return true;
  }
};

// Inverse of a square root of the covariance.
inline Matrix8d WhiteningOf(const Matrix8d& covariance) {
  return Eigen::LLT<Matrix8d>(covariance).matrixL().solve(Matrix8d::Identity());
}

// Huber limit of the whitened residual length; one in 5000 correct markers exceeds it. Limits the effect of a
// marker that is wrong as a whole.
inline constexpr double kMarkerHuber = 5.5;

}  // namespace sonarcal::calib
