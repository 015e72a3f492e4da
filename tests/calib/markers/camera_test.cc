#include "calib/markers/camera.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "calib/markers/flat_port.h"

namespace sonarcal::calib {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

FlatPort TiltedPort() {
  FlatPort port{.distance_m = 0.03, .thickness_m = 0.012, .glass_index = 1.49, .water_index = 1.34};
  port.normal = Vector3d(0.05, -0.08, 1.0).normalized();
  return port;
}

TEST(FlatPort, OnTheNormalNothingBends) {
  const FlatPort port = TiltedPort();
  Vector3d direction;
  ASSERT_TRUE(DirectionThroughPort<double>(port, 2.0 * port.normal, direction));
  EXPECT_LT((direction - port.normal).norm(), 1e-15);
}

TEST(FlatPort, WithTheIndexOfAirItIsNotThere) {
  FlatPort port = TiltedPort();
  port.glass_index = port.water_index = 1.0;
  const Vector3d point(0.7, -0.4, 1.5);
  Vector3d direction;
  ASSERT_TRUE(DirectionThroughPort(port, point, direction));
  EXPECT_LT(direction.cross(point).norm(), 1e-14);
}

// Near the axis every layer counts with its depth over its index.
TEST(FlatPort, NearTheAxisDepthsShrinkByTheIndex) {
  const FlatPort port{.distance_m = 0.03, .thickness_m = 0.012, .glass_index = 1.5, .water_index = 1.34};
  const double water_m = 0.9;
  const double apparent_m = 0.03 + 0.012 / 1.5 + water_m / 1.34;
  Vector3d direction;
  ASSERT_TRUE(DirectionThroughPort<double>(port, {1e-5, 0.0, port.outer_m() + water_m}, direction));
  EXPECT_NEAR(direction.x(), 1e-5 / apparent_m, 1e-14);
}

// A thin window far from nothing: Snell's law between air and water alone, sin = w sin_w.
TEST(FlatPort, FarAwayAWindowOnlyTurnsTheRay) {
  const FlatPort port{.distance_m = 0.01, .thickness_m = 1e-6};
  for (const double angle : {0.1, 0.4, 0.7}) {
    Vector3d direction;
    ASSERT_TRUE(
        DirectionThroughPort<double>(port, 1e7 * Vector3d(std::sin(angle), 0.0, std::cos(angle)), direction));
    EXPECT_NEAR(direction.x() / direction.norm(), port.water_index * std::sin(angle), 1e-7);
  }
}

// Fermat: no path beside it is shorter in time.
TEST(FlatPort, ThePathIsTheFastest) {
  const FlatPort port{.distance_m = 0.04, .thickness_m = 0.02, .glass_index = 1.5, .water_index = 1.333};
  const double r = 0.8;
  const double water_m = 1.1;
  Vector3d direction;
  ASSERT_TRUE(DirectionThroughPort<double>(port, {r, 0.0, port.outer_m() + water_m}, direction));
  Vector3d start;
  Vector3d in_water;
  ASSERT_TRUE(RayBehindPort(port, direction, start, in_water));
  const auto time = [&](double inner, double outer) {
    return std::hypot(port.distance_m, inner) +
           port.glass_index * std::hypot(port.thickness_m, outer - inner) +
           port.water_index * std::hypot(water_m, r - outer);
  };
  const double inner = port.distance_m * direction.x();
  for (const double a : {-1e-4, 0.0, 1e-4}) {
    for (const double b : {-1e-4, 0.0, 1e-4}) {
      if (a == 0.0 && b == 0.0) continue;
      EXPECT_GT(time(inner + a, start.x() + b), time(inner, start.x()));
    }
  }
}

TEST(FlatPort, DirectionAndRayThroughThePortAreInverse) {
  const FlatPort port = TiltedPort();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d point(unit(random), unit(random), 1.2 + unit(random));
    Vector3d direction;
    Vector3d start;
    Vector3d in_water;
    ASSERT_TRUE(DirectionThroughPort(port, point, direction));
    ASSERT_TRUE(RayBehindPort(port, direction, start, in_water));
    EXPECT_LT((point - start).cross(in_water).norm(), 1e-12);
    EXPECT_NEAR(port.normal.dot(start), port.outer_m(), 1e-15);
  }
}

TEST(FlatPort, PointsBehindThePortAndBeyondTotalReflectionAreRefused) {
  const FlatPort port = TiltedPort();
  Vector3d direction;
  EXPECT_FALSE(DirectionThroughPort<double>(port, {0.0, 0.0, 0.04}, direction));
  EXPECT_FALSE(DirectionThroughPort<double>(port, {0.0, 0.0, -1.0}, direction));
  EXPECT_FALSE(DirectionThroughPort<double>(port, {std::nan(""), 0.0, 1.0}, direction));
  // A camera that touches the water sees no more than total reflection lets in: 48.6 degrees.
  const FlatPort touching{};
  const auto at_deg = [](double deg) {
    return Vector3d(std::sin(deg * 3.14159265358979 / 180.0), 0.0, std::cos(deg * 3.14159265358979 / 180.0));
  };
  EXPECT_TRUE(DirectionThroughPort(touching, at_deg(48.0), direction));
  EXPECT_FALSE(DirectionThroughPort(touching, at_deg(49.0), direction));
}

Camera FullCamera() {
  Camera camera{.cols = 1280, .rows = 960, .fx_px = 1010.0, .fy_px = 1005.0, .cx_px = 644.0, .cy_px = 471.0};
  camera.distortion = {-0.21, 0.08, 0.001, -0.002, -0.01, 0.02, -0.01, 0.003, 0.001, -0.0005, 0.0007, 0.0002};
  return camera;
}

TEST(Camera, ProjectsAsOpenCvDoes) {
  const Camera camera = FullCamera();
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<cv::Point3d> points;
  for (int i = 0; i < 200; ++i)
    points.emplace_back(unit(random), 0.8 * unit(random), 1.6 + 0.3 * unit(random));
  const cv::Mat matrix =
      (cv::Mat_<double>(3, 3) << camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
  const std::vector<double> coefficients(camera.distortion.begin(), camera.distortion.end());
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), matrix, coefficients, pixels);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vector2d pixel;
    ASSERT_TRUE(PixelOfPoint<double>(camera, nullptr, 1.0, {points[i].x, points[i].y, points[i].z}, pixel));
    EXPECT_LT((pixel - Vector2d(pixels[i].x, pixels[i].y)).norm(), 1e-9);
  }
}

TEST(Camera, JetsCarryTheDerivative) {
  const Camera camera = FullCamera();
  const FlatPort port = TiltedPort();
  using Jet = ceres::Jet<double, 4>;
  for (const Vector3d& point :
       {Vector3d(0.4, -0.3, 1.1), Vector3d(1e-9, 0.0, 0.7), Vector3d(-0.8, 0.5, 0.9)}) {
    const Eigen::Matrix<Jet, 3, 1> seeded(Jet(point.x(), 0), Jet(point.y(), 1), Jet(point.z(), 2));
    Eigen::Matrix<Jet, 2, 1> pixel;
    ASSERT_TRUE(PixelOfPoint(camera, &port, Jet(1.0, 3), seeded, pixel));
    for (int k = 0; k < 4; ++k) {
      constexpr double kStep = 1e-6;
      const auto shifted = [&](double step) {
        Vector2d result;
        const Vector3d moved = k < 3 ? Vector3d(point + step * Vector3d::Unit(k)) : point;
        EXPECT_TRUE(PixelOfPoint(camera, &port, k == 3 ? 1.0 + step : 1.0, moved, result));
        return result;
      };
      const Vector2d slope = (shifted(kStep) - shifted(-kStep)) / (2.0 * kStep);
      EXPECT_NEAR(pixel.x().v[k], slope.x(), 1e-5 * (1.0 + slope.norm()));
      EXPECT_NEAR(pixel.y().v[k], slope.y(), 1e-5 * (1.0 + slope.norm()));
    }
  }
}

TEST(Camera, StraightCoordinatesAndPixelsAreInverse) {
  const Camera camera = FullCamera();
  const FlatPort port = TiltedPort();
  for (const FlatPort* window : {static_cast<const FlatPort*>(nullptr), &port}) {
    for (double u = 0.0; u < camera.cols; u += 160.0) {
      for (double v = 0.0; v < camera.rows; v += 160.0) {
        const auto straight = StraightFromPixel(camera, window, 1.3, {u, v});
        ASSERT_TRUE(straight);
        const auto back = PixelFromStraight(camera, window, 1.3, *straight);
        ASSERT_TRUE(back);
        EXPECT_LT((*back - Vector2d(u, v)).norm(), 1e-8);
      }
    }
  }
  EXPECT_FALSE(StraightFromPixel(camera, &port, 0.02, {600.0, 400.0}));  // a plane before the window
}

// r (1 - r^2) turns back at r = 0.577, where it is 0.385: no direction has a pixel farther out.
TEST(Camera, APixelThatTheDistortionDoesNotReachHasNoDirection) {
  Camera camera{.cols = 1000, .rows = 1000, .fx_px = 500.0, .fy_px = 500.0, .cx_px = 500.0, .cy_px = 500.0};
  camera.distortion[0] = -1.0;
  EXPECT_TRUE(StraightFromPixel(camera, nullptr, 1.0, {500.0 + 500.0 * 0.38, 500.0}));
  EXPECT_FALSE(StraightFromPixel(camera, nullptr, 1.0, {500.0 + 500.0 * 0.39, 500.0}));
}

}  // namespace
}  // namespace sonarcal::calib
