// Refraction at a flat port: the direction in which a camera behind a window sees a point in the water.
//
// The camera is in air at the origin. The inner face of the window lies at distance d along the unit normal
// n. The window is t thick (index g), and water (index w) begins behind it. For a point at depth z along n
// and distance r from the axis through the camera, the ray that leaves the camera with tangent q = tan(angle
// in air) reaches it, by Snell's law sin = g sin_g = w sin_w, if
//
//   d q + t q / sqrt(g^2 + (g^2 - 1) q^2) + h q / sqrt(w^2 + (w^2 - 1) q^2) = r,   h = z - d - t.
//
// With m = q / r, which stays finite on the axis, this is F(m, r^2, z) = 0. F rises and is concave in m for
// indices >= 1, so Newton's steps from m = 0 approach the root from below and never pass it. The direction is
// n + m (P - z n). There is no other ray (Fermat). Not modelled: the colour of the light, the curvature of
// the window. A pinhole with distortion cannot replace this model, because the shift depends on depth
// (Treibitz et al. 2012, Agrawal et al. 2012).
//
// Templated on the scalar. With Ceres' jets, the last Newton step carries the derivative (implicit function).
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/types/camera.h"

namespace sonarcal::calib {

// Contribution of one layer of index n and depth h to F(m), h m / sqrt(n^2 + (n^2 - 1) q^2), and its slope.
template <typename T>
struct PortLayer {
  T value;
  T slope;
};

template <typename T>
PortLayer<T> LayerOf(const T& depth_m, double index, const T& m, const T& r2) {
  using std::sqrt;
  const double n2 = index * index;
  const T root2 = n2 + (n2 - 1.0) * m * m * r2;
  const T root = sqrt(root2);
  return {depth_m * m / root, depth_m * n2 / (root2 * root)};
}

// Computes the direction in the camera frame in which `point_m` is seen, with unit length along the normal.
// Returns false if the point is not behind the window or if no ray reaches it so far from the axis (a camera
// that touches the window).
template <typename T>
bool DirectionThroughPort(const FlatPort& port, const Eigen::Matrix<T, 3, 1>& point_m,
                          Eigen::Matrix<T, 3, 1>& direction) {
  const Eigen::Matrix<T, 3, 1> normal = port.normal.cast<T>();
  const T z = normal.dot(point_m);
  const Eigen::Matrix<T, 3, 1> aside = point_m - z * normal;
  const T r2 = aside.squaredNorm();
  const T water_m = z - T(port.outer_m());
  if (!(water_m > T(0.0))) return false;
  T m(0.0);
  constexpr int kMaxSteps = 100;
  constexpr double kMaxTangent2 = 1e12;  // along the window
  for (int step = 0; step < kMaxSteps; ++step) {
    const PortLayer<T> glass = LayerOf(T(port.thickness_m), port.glass_index, m, r2);
    const PortLayer<T> water = LayerOf(water_m, port.water_index, m, r2);
    const T change = -(T(port.distance_m) * m + glass.value + water.value - T(1.0)) /
                     (T(port.distance_m) + glass.slope + water.slope);
    m += change;
    if (!(m * m * r2 < T(kMaxTangent2))) return false;
    // Takes one step more than the value needs, because the derivative of a jet lags one step behind.
    if (!(change * change > T(1e-26) * m * m)) {
      direction = normal + m * aside;
      return true;
    }
  }
  return false;
}

// Inverse: computes the ray in the water of a direction in the air of the camera. `start_m`: its start on the
// outer face of the window. `in_water` has unit length. Returns false for a direction that does not meet the
// window.
inline bool RayBehindPort(const FlatPort& port, const Eigen::Vector3d& in_air, Eigen::Vector3d& start_m,
                          Eigen::Vector3d& in_water) {
  const double length = in_air.norm();
  const double cosine = port.normal.dot(in_air) / length;
  if (!(cosine > 0.0)) return false;
  const Eigen::Vector3d sine = in_air / length - cosine * port.normal;  // length is the sine of the angle
  const auto aside = [&](double index) -> Eigen::Vector3d {             // offset per metre along the normal
    return sine / std::sqrt(index * index - sine.squaredNorm());
  };
  const double index = port.water_index;
  start_m = port.outer_m() * port.normal + port.distance_m * aside(1.0) +
            port.thickness_m * aside(port.glass_index);
  in_water = (aside(index) + port.normal).normalized();
  return true;
}

}  // namespace sonarcal::calib
