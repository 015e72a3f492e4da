#include "tests/support/marker_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "data_io/parameters/marker_map_io.h"
#include "tests/support/marker_print.h"

namespace sonarcal::testing {
namespace {

constexpr double kFloorGrey = 120.0;
constexpr double kBlack = 35.0;
constexpr double kWhite = 205.0;
constexpr double kPaper = 1.35;  // of a marker's side, white margin included

// OpenCV's forward model, undone by repeated substitution.
Eigen::Vector3d RayOfPixel(const Camera& camera, double u, double v) {
  const double xd = (u - camera.cx_px) / camera.fx_px;
  const double yd = (v - camera.cy_px) / camera.fy_px;
  const auto& d = camera.distortion;
  double x = xd;
  double y = yd;
  for (int i = 0; i < 100; ++i) {
    const double r2 = x * x + y * y;
    const double radial = (1 + d[0] * r2 + d[1] * r2 * r2 + d[4] * r2 * r2 * r2) /
                          (1 + d[5] * r2 + d[6] * r2 * r2 + d[7] * r2 * r2 * r2);
    const double dx = 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x) + d[8] * r2 + d[9] * r2 * r2;
    const double dy = d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y + d[10] * r2 + d[11] * r2 * r2;
    const double before = x + y;
    x = (xd - dx) / radial;
    y = (yd - dy) / radial;
    if (std::abs(x + y - before) < 1e-14) break;
  }
  return Eigen::Vector3d(x, y, 1.0).normalized();
}

// Snell's law for vectors; `ratio` is the index before over the index behind.
Eigen::Vector3d Refracted(const Eigen::Vector3d& incoming, const Eigen::Vector3d& normal, double ratio) {
  const double cos_in = normal.dot(incoming);
  const double cos_out = std::sqrt(1.0 - ratio * ratio * (1.0 - cos_in * cos_in));
  return ratio * incoming + (cos_out - ratio * cos_in) * normal;
}

}  // namespace

MarkerMap MarkerField(const FieldOptions& options) {
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  MarkerMap map{.dictionary = options.dictionary, .markers = {}, .sigma = {}};
  for (int row = 0; row < options.rows; ++row) {
    for (int col = 0; col < options.cols; ++col) {
      const double free_m = 0.3 * (options.spacing_m - 1.5 * options.size_m);
      Eigen::Vector3d position((col - 0.5 * (options.cols - 1)) * options.spacing_m + free_m * unit(random),
                               (row - 0.5 * (options.rows - 1)) * options.spacing_m + free_m * unit(random),
                               0.0);
      Eigen::Quaterniond rotation(Eigen::AngleAxisd(3.14159 * unit(random), Eigen::Vector3d::UnitZ()));
      if (!options.flat) {
        position.z() = 0.1 + 0.1 * unit(random);
        rotation = rotation * Eigen::AngleAxisd(0.35 * unit(random), Eigen::Vector3d::UnitX());
      }
      map.markers.push_back({row * options.cols + col, options.size_m, {rotation, position}});
    }
  }
  return map;
}

Camera FieldCamera() {
  Camera camera{.cols = 640, .rows = 480, .fx_px = 560.0, .fy_px = 558.0, .cx_px = 322.3, .cy_px = 237.6};
  camera.distortion = {-0.18, 0.07, 0.0012, -0.0009, -0.01};
  return camera;
}

Pose LookingDown(double height_m, const Eigen::Vector2d& aside_m, const Eigen::Vector2d& target_m,
                 double spin_rad) {
  const Eigen::Vector3d eye(aside_m.x(), aside_m.y(), height_m);
  const Eigen::Vector3d ahead = (Eigen::Vector3d(target_m.x(), target_m.y(), 0.0) - eye).normalized();
  const Eigen::Vector3d right =
      ahead.cross(Eigen::Vector3d(std::sin(spin_rad), std::cos(spin_rad), 0.0)).normalized();
  Eigen::Matrix3d axes;
  axes << right, ahead.cross(right), ahead;
  return {Eigen::Quaterniond(axes), eye};
}

FieldRenderer::FieldRenderer(const MarkerMap& map, const Camera& camera, const FlatPort* port,
                             int supersampling)
    : camera_(camera), supersampling_(supersampling) {
  const double part = 1.0 / supersampling;
  for (int row = 0; row < camera.rows * supersampling; ++row) {
    for (int col = 0; col < camera.cols * supersampling; ++col) {
      // Pixel (0, 0) reaches from -0.5 to 0.5.
      Ray ray{Eigen::Vector3d::Zero(),
              RayOfPixel(camera, (col + 0.5) * part - 0.5, (row + 0.5) * part - 0.5)};
      if (port != nullptr) {
        const Eigen::Vector3d& n = port->normal;
        ray.origin = ray.direction * (port->distance_m / n.dot(ray.direction));
        ray.direction = Refracted(ray.direction, n, 1.0 / port->glass_index);
        ray.origin += ray.direction * (port->thickness_m / n.dot(ray.direction));
        ray.direction = Refracted(ray.direction, n, port->glass_index / port->water_index);
      }
      rays_.push_back(ray);
    }
  }
  if (camera.rows % 16 != 0 || camera.cols % 16 != 0) throw std::logic_error("sides not multiples of 16");
  const data_io::MarkerDictionary* dictionary = data_io::FindMarkerDictionary(map.dictionary);
  if (dictionary == nullptr) throw std::logic_error("no such dictionary");
  for (const Marker& marker : map.markers) {
    sheets_.push_back({marker.world_from_marker.Inverse(), marker.size_m,
                       MarkerPrint(dictionary->opencv_code, marker.id, dictionary->cells)});
  }
}

// Where a ray meets the plane of a sheet, in the sheet's frame; `distance` negative where it does not.
FieldRenderer::Meeting FieldRenderer::Meet(const Ray& ray, const PlacedSheet& sheet) {
  const Eigen::Vector3d d = sheet.rotation * ray.direction;
  if (!(d.z() < 0.0)) return {};  // from behind
  const Eigen::Vector3d o = sheet.rotation * ray.origin + sheet.position_m;
  const double t = -o.z() / d.z();
  return {t, o.x() + t * d.x(), o.y() + t * d.y()};
}

double FieldRenderer::GreyAlong(const Ray& ray, const std::vector<PlacedSheet>& sheets) {
  double nearest = std::numeric_limits<double>::infinity();
  double grey = kFloorGrey;
  for (const PlacedSheet& sheet : sheets) {
    const Meeting hit = Meet(ray, sheet);
    if (!(hit.distance > 0.0 && hit.distance < nearest)) continue;
    const double half = 0.5 * sheet.sheet->size_m;
    if (std::abs(hit.x) > kPaper * half || std::abs(hit.y) > kPaper * half) continue;
    nearest = hit.distance;
    grey = kWhite;
    if (std::abs(hit.x) < half && std::abs(hit.y) < half) {
      const Grid<std::uint8_t>& cells = sheet.sheet->cells;
      const int n = cells.rows();
      const int col = std::clamp(static_cast<int>((hit.x + half) / (2.0 * half) * n), 0, n - 1);
      const int row = std::clamp(static_cast<int>((half - hit.y) / (2.0 * half) * n), 0, n - 1);
      grey = cells(row, col) > 0 ? kWhite : kBlack;
    }
  }
  return grey;
}

// The sheets that the rays of a tile can meet: its four corner rays say where on the sheet's plane it lies.
std::vector<FieldRenderer::PlacedSheet> FieldRenderer::SheetsOfTile(const std::vector<PlacedSheet>& sheets,
                                                                    int row, int col, int size) const {
  const int cols = camera_.cols * supersampling_;
  std::vector<PlacedSheet> near;
  for (const PlacedSheet& sheet : sheets) {
    std::array<Meeting, 4> corners;
    bool in_front = true;
    for (int k = 0; k < 4; ++k) {
      const std::size_t at =
          static_cast<std::size_t>(row + (k / 2) * (size - 1)) * cols + col + (k % 2) * (size - 1);
      corners[k] = Meet(rays_[at], sheet);
      in_front = in_front && corners[k].distance > 0.0;
    }
    if (!in_front) continue;  // the cameras here look down on all of them
    double reach = kPaper * std::sqrt(0.5) * sheet.sheet->size_m;
    reach += std::hypot(corners[3].x - corners[0].x, corners[3].y - corners[0].y);
    if (std::hypot(corners[0].x, corners[0].y) < reach) near.push_back(sheet);
  }
  return near;
}

Grid<std::uint8_t> FieldRenderer::Render(const Pose& world_from_camera, const PictureOptions& options) const {
  const int n = supersampling_;
  cv::Mat sum(camera_.rows, camera_.cols, CV_64FC1, cv::Scalar(0.0));
  std::vector<PlacedSheet> sheets;
  for (const Sheet& sheet : sheets_) {
    const Pose marker_from_camera = sheet.marker_from_world * world_from_camera;
    sheets.push_back({&sheet, marker_from_camera.rotation.toRotationMatrix(), marker_from_camera.position_m});
  }
  const int tile = 16 * n;  // rays a side; the image's sides are multiples of 16 pixels
  for (int top = 0; top < camera_.rows * n; top += tile) {
    for (int left = 0; left < camera_.cols * n; left += tile) {
      const std::vector<PlacedSheet> near = SheetsOfTile(sheets, top, left, tile);
      for (int row = top; row < top + tile; ++row) {
        for (int col = left; col < left + tile; ++col) {
          const std::size_t at = static_cast<std::size_t>(row) * camera_.cols * n + col;
          sum.at<double>(row / n, col / n) += GreyAlong(rays_[at], near) / (n * n);
        }
      }
    }
  }
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < options.occluders; ++i) {
    const cv::Point centre(static_cast<int>(unit(random) * camera_.cols),
                           static_cast<int>(unit(random) * camera_.rows));
    cv::circle(sum, centre, static_cast<int>(15.0 + 25.0 * unit(random)), cv::Scalar(90.0), cv::FILLED);
  }
  if (options.blur_px > 0.0)
    cv::GaussianBlur(sum, sum, cv::Size(0, 0), options.blur_px, options.blur_px, cv::BORDER_REPLICATE);
  std::normal_distribution<double> noise(0.0, 1.0);
  Grid<std::uint8_t> grey(camera_.rows, camera_.cols);
  for (int row = 0; row < camera_.rows; ++row) {
    for (int col = 0; col < camera_.cols; ++col) {
      const double value = sum.at<double>(row, col) + options.noise_grey * noise(random);
      grey(row, col) = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
    }
  }
  return grey;
}

}  // namespace sonarcal::testing
