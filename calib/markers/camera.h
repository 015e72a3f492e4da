// Projection of a point by a camera: pinhole, polynomial distortion of OpenCV, and optionally a flat port.
//
// With (x, y) = (X / Z, Y / Z) and r^2 = x^2 + y^2 (OpenCV's documentation of calib3d):
//
//   x' = x a + 2 p1 x y + p2 (r^2 + 2 x^2) + s1 r^2 + s2 r^4,   a = (1 + k1 r^2 + k2 r^4 + k3 r^6)
//   y' = y a + p1 (r^2 + 2 y^2) + 2 p2 x y + s3 r^2 + s4 r^4       / (1 + k4 r^2 + k5 r^4 + k6 r^6)
//   u = fx x' + cx,  v = fy y' + cy
//
// Templated on the scalar, for Ceres.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <optional>

#include "calib/markers/flat_port.h"
#include "core/types/camera.h"

namespace sonarcal::calib {

template <typename T>
Eigen::Matrix<T, 2, 1> Distorted(const Camera& camera, const Eigen::Matrix<T, 2, 1>& xy) {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4] = camera.distortion;
  const T& x = xy.x();
  const T& y = xy.y();
  const T r2 = x * x + y * y;
  const T a = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1.0 + r2 * (k4 + r2 * (k5 + r2 * k6)));
  return {x * a + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x) + r2 * (s1 + r2 * s2),
          y * a + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y + r2 * (s3 + r2 * s4)};
}

// Projects a direction in the camera frame to a pixel. `focal_scale` multiplies both focal lengths. Returns
// false for a direction behind the camera.
template <typename T>
bool PixelOfDirection(const Camera& camera, const T& focal_scale, const Eigen::Matrix<T, 3, 1>& direction,
                      Eigen::Matrix<T, 2, 1>& pixel) {
  if (!(direction.z() > T(0.0))) return false;
  const Eigen::Matrix<T, 2, 1> xy(direction.x() / direction.z(), direction.y() / direction.z());
  const Eigen::Matrix<T, 2, 1> bent = Distorted(camera, xy);
  pixel = {focal_scale * camera.fx_px * bent.x() + camera.cx_px,
           focal_scale * camera.fy_px * bent.y() + camera.cy_px};
  return true;
}

// Projects a point in the camera frame, metres, to a pixel. `port`: null for none. Returns false if the point
// is not visible.
template <typename T>
bool PixelOfPoint(const Camera& camera, const FlatPort* port, const T& focal_scale,
                  const Eigen::Matrix<T, 3, 1>& point_m, Eigen::Matrix<T, 2, 1>& pixel) {
  if (port == nullptr) return PixelOfDirection(camera, focal_scale, point_m, pixel);
  Eigen::Matrix<T, 3, 1> direction;
  return DirectionThroughPort(*port, point_m, direction) &&
         PixelOfDirection(camera, focal_scale, direction, pixel);
}

// Intersection of a pixel's ray with the plane `depth_m` ahead of the camera, as (X, Y) / depth. Straight
// lines of the world are straight in these coordinates. Through a port this holds for lines near that plane;
// without a port the depth does not matter. Nullopt if the distortion does not reach that pixel or if the
// plane is not behind the port.
inline std::optional<Eigen::Vector2d> StraightFromPixel(const Camera& camera, const FlatPort* port,
                                                        double depth_m, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d bent((pixel.x() - camera.cx_px) / camera.fx_px,
                             (pixel.y() - camera.cy_px) / camera.fy_px);
  constexpr double kStep = 1e-6;
  constexpr double kClose = 1e-12;
  Eigen::Vector2d xy = bent;
  bool found = false;
  for (int i = 0; i < 50 && !found; ++i) {
    const Eigen::Vector2d miss = Distorted(camera, xy) - bent;
    Eigen::Matrix2d slope;
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(k);
      const Eigen::Vector2d ahead = xy + step;
      const Eigen::Vector2d behind = xy - step;
      slope.col(k) = (Distorted(camera, ahead) - Distorted(camera, behind)) / (2.0 * kStep);
    }
    // A distortion that folds over maps two directions to one pixel. The outer one is not real.
    if (!(slope.determinant() > 0.0)) return std::nullopt;
    xy -= slope.inverse() * miss;
    found = miss.norm() < kClose;
  }
  if (!found || !xy.allFinite()) return std::nullopt;
  if (port == nullptr) return xy;
  Eigen::Vector3d start;
  Eigen::Vector3d in_water;
  if (!RayBehindPort(*port, xy.homogeneous(), start, in_water)) return std::nullopt;
  if (!(in_water.z() > 0.0) || !(start.z() < depth_m)) return std::nullopt;
  const Eigen::Vector3d point = start + (depth_m - start.z()) / in_water.z() * in_water;
  return Eigen::Vector2d(point.head<2>() / depth_m);
}

// Inverse of StraightFromPixel. Nullopt if there is no pixel.
inline std::optional<Eigen::Vector2d> PixelFromStraight(const Camera& camera, const FlatPort* port,
                                                        double depth_m, const Eigen::Vector2d& straight) {
  const Eigen::Vector3d point = depth_m * straight.homogeneous();
  Eigen::Vector2d pixel;
  if (!PixelOfPoint(camera, port, 1.0, point, pixel)) return std::nullopt;
  return pixel;
}

}  // namespace sonarcal::calib
