#include "calib/markers/marker_corners.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/markers/camera.h"
#include "core/math/statistics.h"

namespace sonarcal::calib {
namespace {

using Eigen::Vector2d;

constexpr double kWindowOfCell = 0.45;  // half the window across an edge, as a fraction of a cell's width
constexpr double kLeastWindowPx = 1.0;
constexpr double kMaxWindowPx = 3.0;
constexpr int kLeastSamples = 4;
constexpr double kLeastContrast = 10.0;  // grey levels
constexpr double kMaxScatterPx = 1.0;
constexpr int kPasses = 8;
constexpr double kStillPx = 1e-3;

// Coordinates in which camera and port leave lines straight, in units of about a pixel.
class Straightener {
 public:
  Straightener(const Camera& camera, const FlatPort* port, double depth_m)
      : camera_(camera), port_(port), depth_m_(depth_m), scale_px_(std::sqrt(camera.fx_px * camera.fy_px)) {}

  std::optional<Vector2d> FromPixel(const Vector2d& pixel) const {
    const auto straight = StraightFromPixel(camera_, port_, depth_m_, pixel);
    if (!straight) return std::nullopt;
    return Vector2d(scale_px_ * *straight);
  }

  std::optional<Vector2d> ToPixel(const Vector2d& straight_px) const {
    return PixelFromStraight(camera_, port_, depth_m_, straight_px / scale_px_);
  }

 private:
  const Camera& camera_;
  const FlatPort* port_;
  double depth_m_;
  double scale_px_;
};

std::optional<double> GreyAt(const Grid<std::uint8_t>& grey, const Vector2d& pixel) {
  const double u0 = std::floor(pixel.x());
  const double v0 = std::floor(pixel.y());
  if (!(u0 >= 0.0 && v0 >= 0.0 && u0 + 1.0 < grey.cols() && v0 + 1.0 < grey.rows())) return std::nullopt;
  const int col = static_cast<int>(u0);
  const int row = static_cast<int>(v0);
  const double a = pixel.x() - u0;
  const double b = pixel.y() - v0;
  return (1.0 - b) * ((1.0 - a) * grey(row, col) + a * grey(row, col + 1)) +
         b * ((1.0 - a) * grey(row + 1, col) + a * grey(row + 1, col + 1));
}

// Grey profile across the edge, from inside to outside.
struct Profile {
  double first = 0.0;
  double last = 0.0;
  double integral = 0.0;  // grey times pixels
};

std::optional<Profile> ProfileAt(const Grid<std::uint8_t>& grey, const Vector2d& centre,
                                 const Vector2d& outward, double half_px) {
  const int steps = std::max(4, static_cast<int>(std::ceil(4.0 * half_px)));
  const double step_px = 2.0 * half_px / steps;
  Profile profile;
  for (int i = 0; i <= steps; ++i) {
    const auto value = GreyAt(grey, centre + (i * step_px - half_px) * outward);
    if (!value) return std::nullopt;
    if (i == 0) profile.first = *value;
    if (i == steps) profile.last = *value;
    profile.integral += (i == 0 || i == steps ? 0.5 : 1.0) * step_px * *value;
  }
  return profile;
}

// A line in straight coordinates, with statistics of its samples.
struct EdgeLine {
  Vector2d centre;     // mean of the samples
  Vector2d direction;  // unit length
  Vector2d normal;
  double samples = 0.0;
  double spread2 = 0.0;   // sum of squared distances of the samples from the centre along the line
  double scatter2 = 0.0;  // sum of squared distances from the line

  double Along(const Vector2d& point) const { return direction.dot(point - centre); }
};

std::optional<EdgeLine> FitLine(const std::vector<Vector2d>& points, const Vector2d& direction) {
  std::vector<bool> used(points.size(), true);
  EdgeLine line;
  const Vector2d normal(-direction.y(), direction.x());
  for (int round = 0; round < 3; ++round) {
    Vector2d sum = Vector2d::Zero();
    line.samples = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!used[i]) continue;
      sum += points[i];
      line.samples += 1.0;
    }
    if (line.samples < kLeastSamples) return std::nullopt;
    line.centre = sum / line.samples;
    double tt = 0.0;
    double tn = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!used[i]) continue;
      const double t = direction.dot(points[i] - line.centre);
      tt += t * t;
      tn += t * normal.dot(points[i] - line.centre);
    }
    line.direction = (direction + tn / tt * normal).normalized();
    line.normal = {-line.direction.y(), line.direction.x()};
    line.spread2 = tt;
    line.scatter2 = 0.0;
    std::vector<double> distances;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double distance = line.normal.dot(points[i] - line.centre);
      distances.push_back(std::abs(distance));
      if (used[i]) line.scatter2 += distance * distance;
    }
    const double most = 3.5 * kSigmaPerMad * UpperMedian(distances) + 1e-6;
    if (round == 2) break;
    for (std::size_t i = 0; i < points.size(); ++i) used[i] = distances[i] <= most;
  }
  return line;
}

using Quad = std::array<Vector2d, 4>;

// Half the window across the edge from corner e: within the border of one cell where that is narrowest.
double WindowPx(const Quad& pixels, int e, int cells) {
  const Vector2d& a = pixels[e];
  const Vector2d along = (pixels[(e + 1) % 4] - a).normalized();
  const Vector2d across(-along.y(), along.x());
  const double width_px =
      std::min(std::abs(across.dot(pixels[(e + 2) % 4] - a)), std::abs(across.dot(pixels[(e + 3) % 4] - a)));
  return std::clamp(kWindowOfCell * width_px / cells, kLeastWindowPx, kMaxWindowPx);
}

std::optional<EdgeLine> MeasureEdge(const Grid<std::uint8_t>& grey, const Straightener& straightener,
                                    const Quad& straight, const Quad& pixels, int e, int cells) {
  const Vector2d& a = straight[e];
  const Vector2d& b = straight[(e + 1) % 4];
  const double length_px = (pixels[(e + 1) % 4] - pixels[e]).norm();
  const double half_px = WindowPx(pixels, e, cells);
  const double margin_px = half_px + 1.0;
  const int count = static_cast<int>(std::floor(length_px - 2.0 * margin_px)) + 1;
  if (count < kLeastSamples) return std::nullopt;
  const Vector2d middle = 0.25 * (pixels[0] + pixels[1] + pixels[2] + pixels[3]);

  struct Sample {
    Vector2d pixel;
    Vector2d outward;
    Profile profile;
  };
  std::vector<Sample> samples;
  double contrast = 0.0;
  for (int i = 0; i < count; ++i) {
    const double part = (margin_px + i * (length_px - 2.0 * margin_px) / std::max(1, count - 1)) / length_px;
    const double nearby = 0.5 / length_px;
    const auto pixel = straightener.ToPixel(a + part * (b - a));
    const auto before = straightener.ToPixel(a + (part - nearby) * (b - a));
    const auto after = straightener.ToPixel(a + (part + nearby) * (b - a));
    if (!pixel || !before || !after) return std::nullopt;
    const Vector2d along = (*after - *before).normalized();
    Vector2d outward(-along.y(), along.x());
    if (outward.dot(*pixel - middle) < 0.0) outward = -outward;
    const auto profile = ProfileAt(grey, *pixel, outward, half_px);
    if (!profile) return std::nullopt;
    samples.push_back({*pixel, outward, *profile});
    contrast += (profile->last - profile->first) / count;
  }
  if (!(contrast >= kLeastContrast)) return std::nullopt;
  std::vector<Vector2d> points;
  for (const Sample& sample : samples) {
    const Profile& p = sample.profile;
    const double offset_px =
        std::clamp((half_px * (p.first + p.last) - p.integral) / contrast, -half_px, half_px);
    const auto point = straightener.FromPixel(sample.pixel + offset_px * sample.outward);
    if (!point) return std::nullopt;
    points.push_back(*point);
  }
  return FitLine(points, (b - a).normalized());
}

// Intersections of line e - 1 and line e: corner e.
std::optional<Quad> Corners(const std::array<EdgeLine, 4>& lines) {
  Quad corners;
  for (int e = 0; e < 4; ++e) {
    const EdgeLine& one = lines[(e + 3) % 4];
    const EdgeLine& other = lines[e];
    Eigen::Matrix2d normals;
    normals << one.normal.transpose(), other.normal.transpose();
    if (std::abs(normals.determinant()) < 0.05) return std::nullopt;
    corners[e] = normals.inverse() * Vector2d(one.normal.dot(one.centre), other.normal.dot(other.centre));
  }
  return corners;
}

std::optional<Quad> ToPixels(const Straightener& straightener, const Quad& straight) {
  Quad pixels;
  for (int k = 0; k < 4; ++k) {
    const auto pixel = straightener.ToPixel(straight[k]);
    if (!pixel) return std::nullopt;
    pixels[k] = *pixel;
  }
  return pixels;
}

// Propagates offset and slope of each line, which are independent, to the corner pixels.
std::optional<Matrix8d> CornerCovariance(const std::array<EdgeLine, 4>& lines, const Quad& straight,
                                         const Straightener& straightener) {
  double scatter2 = 0.0;
  double freedom = -8.0;
  for (const EdgeLine& line : lines) {
    scatter2 += line.scatter2;
    freedom += line.samples;
  }
  const double sample_variance = scatter2 / std::max(1.0, freedom);
  if (!(sample_variance < kMaxScatterPx * kMaxScatterPx)) return std::nullopt;

  Matrix8d slope = Matrix8d::Zero();  // derivatives of the corners by (offset, slope) of each line
  for (int e = 0; e < 4; ++e) {
    const int previous = (e + 3) % 4;
    Eigen::Matrix2d normals;
    normals << lines[previous].normal.transpose(), lines[e].normal.transpose();
    const Eigen::Matrix2d inverse = normals.inverse();
    Eigen::Matrix2d bend;
    constexpr double kStepPx = 0.01;
    for (int k = 0; k < 2; ++k) {
      const Vector2d step = kStepPx * Vector2d::Unit(k);
      const auto ahead = straightener.ToPixel(straight[e] + step);
      const auto behind = straightener.ToPixel(straight[e] - step);
      if (!ahead || !behind) return std::nullopt;
      bend.col(k) = (*ahead - *behind) / (2.0 * kStepPx);
    }
    const Eigen::Matrix2d pixel_per_offset = bend * inverse;
    slope.block<2, 1>(2 * e, 2 * previous) = pixel_per_offset.col(0);
    slope.block<2, 1>(2 * e, 2 * previous + 1) = pixel_per_offset.col(0) * lines[previous].Along(straight[e]);
    slope.block<2, 1>(2 * e, 2 * e) = pixel_per_offset.col(1);
    slope.block<2, 1>(2 * e, 2 * e + 1) = pixel_per_offset.col(1) * lines[e].Along(straight[e]);
  }
  Eigen::Matrix<double, 8, 1> variance;
  for (int e = 0; e < 4; ++e) {
    variance(2 * e) = sample_variance / lines[e].samples;
    variance(2 * e + 1) = sample_variance / lines[e].spread2;
  }
  // Min standard deviation of an edge, because interpolation and camera calibration are not more accurate.
  constexpr double kFloorPx = 0.005;
  return slope * variance.asDiagonal() * slope.transpose() + kFloorPx * kFloorPx * Matrix8d::Identity();
}

}  // namespace

double MarkerDepthM(const MarkerQuad& quad, double size_m, const Camera& camera, const FlatPort* port) {
  double side_px = 1.0;
  for (int k = 0; k < 4; ++k)
    side_px = std::max(side_px, (quad.corners_px[(k + 1) % 4] - quad.corners_px[k]).norm());
  const double focal_px = std::sqrt(camera.fx_px * camera.fy_px);
  if (port == nullptr) return focal_px * size_m / side_px;
  // Near the axis, water magnifies by its index, and all distances count from the window.
  return port->outer_m() + std::max(1e-3, port->water_index * focal_px * size_m / side_px - port->distance_m);
}

std::optional<MarkerObservation> RefineMarkerCorners(const Grid<std::uint8_t>& grey, const MarkerQuad& quad,
                                                     const MarkerShape& shape, const Camera& camera,
                                                     const FlatPort* port) {
  const int cells = shape.cells;
  const Straightener straightener(camera, port, MarkerDepthM(quad, shape.size_m, camera, port));
  Quad straight;
  for (int k = 0; k < 4; ++k) {
    const auto point = straightener.FromPixel(quad.corners_px[k]);
    if (!point) return std::nullopt;
    straight[k] = *point;
  }
  Quad pixels = quad.corners_px;
  std::array<EdgeLine, 4> lines;
  for (int pass = 0; pass < kPasses; ++pass) {
    for (int e = 0; e < 4; ++e) {
      const auto line = MeasureEdge(grey, straightener, straight, pixels, e, cells);
      if (!line) return std::nullopt;
      lines[e] = *line;
    }
    const auto corners = Corners(lines);
    if (!corners) return std::nullopt;
    double moved_px = 0.0;
    for (int k = 0; k < 4; ++k) moved_px = std::max(moved_px, ((*corners)[k] - straight[k]).norm());
    straight = *corners;
    const auto moved = ToPixels(straightener, straight);
    if (!moved) return std::nullopt;
    pixels = *moved;
    if (moved_px < kStillPx) break;
  }
  // Rejects a line that moved to another edge: bits of the marker, or something beside it.
  for (int k = 0; k < 4; ++k) {
    const double side_px = (quad.corners_px[(k + 1) % 4] - quad.corners_px[k]).norm();
    if ((pixels[k] - quad.corners_px[k]).norm() > std::max(3.0, side_px / cells)) return std::nullopt;
  }
  const auto covariance = CornerCovariance(lines, straight, straightener);
  if (!covariance) return std::nullopt;
  return MarkerObservation{quad.id, pixels, *covariance};
}

}  // namespace sonarcal::calib
