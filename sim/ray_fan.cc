#include "sim/ray_fan.h"

#include <algorithm>
#include <cmath>

#include "data_io/types/error.h"
#include "data_io/types/units.h"
#include "sim/row_math.h"

namespace sonarcal {
namespace {

constexpr double kWidestPinholeDeg = 85.0;

}  // namespace

void RayFanOptions::Check() const {
  if (cols < 1 || cols > 100'000) throw DataError("rays: {} columns, expected 1 .. 100000", cols);
  if (rows < 1 || rows > 100'000) throw DataError("rays: {} rows, expected 1 .. 100000", rows);
  if (static_cast<long>(cols) * rows > 200'000'000) {
    throw DataError("rays: {} x {} is more than 200 million", cols, rows);
  }
  if (!(elevation_span_deg >= 0.0 && elevation_span_deg <= 180.0)) {
    throw DataError("rays: elevation span {} degrees, expected 0 (the sonar's own) .. 180",
                    elevation_span_deg);
  }
  if (!(row_crowding >= 1.0 && row_crowding <= 100.0)) {
    throw DataError("rays: row crowding {}, expected 1 (even) .. 100", row_crowding);
  }
  if (!(azimuth_margin_deg >= 0.0 && azimuth_margin_deg <= 60.0)) {
    throw DataError("rays: azimuth margin {} degrees, expected 0 .. 60", azimuth_margin_deg);
  }
}

RayFan::RayFan(const SonarModel& sonar, const RayFanOptions& options)
    : sampling_(options.sampling), rows_(options.rows) {
  options.Check();
  sonar.axes.Validate(sonar.name);
  beam_edges_rad_ = sonar.axes.BeamEdgesRad();
  const int beams = sonar.axes.beam_count();
  const double span_rad = RadFromDeg(options.elevation_span_deg > 0.0 ? options.elevation_span_deg
                                                                      : sonar.elevation_beam_width_deg);
  if (!(span_rad > 0.0)) {
    throw DataError("{}: elevation beam width {} degrees, expected a positive one", sonar.name,
                    sonar.elevation_beam_width_deg);
  }

  const double margin_rad = RadFromDeg(options.azimuth_margin_deg);
  const double left_rad = beam_edges_rad_.front() - margin_rad;
  const double right_rad = beam_edges_rad_.back() + margin_rad;
  if (sampling_ == Sampling::kFrustum) {
    const double limit_rad = RadFromDeg(kWidestPinholeDeg);
    if (left_rad < -limit_rad || right_rad > limit_rad || span_rad > 2.0 * limit_rad) {
      throw DataError("{}: a pinhole sees at most +-{} degrees; use the sampling 'beams'", sonar.name,
                      kWidestPinholeDeg);
    }
    cols_ = options.cols;
    const double left = std::tan(left_rad);
    const double right = std::tan(right_rad);
    const double top = std::tan(0.5 * span_rad);
    for (int col = 0; col < cols_; ++col) {
      azimuth_rad_.push_back(std::atan(left + (col + 0.5) * (right - left) / cols_));
    }
    for (int row = 0; row < rows_; ++row) row_slope_.push_back(top - (row + 0.5) * 2.0 * top / rows_);
    slope_width_ = (right - left) / cols_;
    slope_height_ = 2.0 * top / rows_;
  } else {
    const int cols_per_beam = (options.cols + beams - 1) / beams;
    // A margin's columns are as wide as the nearest within the beams.
    const auto add_margin = [&](double edge_rad, double width, bool left) {
      const int count = static_cast<int>(std::ceil(margin_rad / width - 1e-9));
      for (int i = 0; i < count; ++i) {
        azimuth_rad_.push_back(left ? edge_rad - (count - i - 0.5) * width : edge_rad + (i + 0.5) * width);
        column_width_rad_.push_back(width);
      }
    };
    add_margin(beam_edges_rad_[0], (beam_edges_rad_[1] - beam_edges_rad_[0]) / cols_per_beam, true);
    for (int beam = 0; beam < beams; ++beam) {
      const double width = (beam_edges_rad_[beam + 1] - beam_edges_rad_[beam]) / cols_per_beam;
      for (int i = 0; i < cols_per_beam; ++i) {
        azimuth_rad_.push_back(beam_edges_rad_[beam] + (i + 0.5) * width);
        column_width_rad_.push_back(width);
      }
    }
    add_margin(beam_edges_rad_[beams], (beam_edges_rad_[beams] - beam_edges_rad_[beams - 1]) / cols_per_beam,
               false);
    cols_ = static_cast<int>(azimuth_rad_.size());
    const double even = 1.0 / options.row_crowding;
    const auto edge_rad = [&](int row) {
      const double u = 1.0 - 2.0 * row / rows_;
      return 0.5 * span_rad * (even + (1.0 - even) * u * u) * u;
    };
    for (int row = 0; row < rows_; ++row) {
      row_elevation_rad_.push_back(0.5 * (edge_rad(row) + edge_rad(row + 1)));
      row_height_rad_.push_back(edge_rad(row) - edge_rad(row + 1));
    }
  }

  for (const double azimuth : azimuth_rad_) {
    column_sine_.push_back(std::sin(azimuth));
    column_cosine_.push_back(std::cos(azimuth));
  }
  for (std::size_t row = 0; row < row_elevation_rad_.size(); ++row) {
    const double elevation = row_elevation_rad_[row];
    const double half_height = 0.5 * row_height_rad_[row];
    row_sine_.push_back(std::sin(elevation));
    row_cosine_.push_back(std::cos(elevation));
    row_sine_height_.push_back(std::sin(elevation + half_height) - std::sin(elevation - half_height));
  }

  const bool pinhole = sampling_ == Sampling::kFrustum;
  for (int col = 0; col < cols_; ++col) {
    column_x_.push_back(
        static_cast<float>(pinhole ? column_sine_[col] / column_cosine_[col] : column_sine_[col]));
    column_y_.push_back(pinhole ? 1.0F : static_cast<float>(column_cosine_[col]));
  }
  for (int row = 0; row < rows_; ++row) {
    row_across_.push_back(pinhole ? 1.0F : static_cast<float>(row_cosine_[row]));
    row_up_.push_back(static_cast<float>(pinhole ? row_slope_[row] : row_sine_[row]));
  }

  rays_per_beam_.assign(beams, 0);
  for (int col = 0; col < cols_; ++col) {
    const auto above = std::upper_bound(beam_edges_rad_.begin(), beam_edges_rad_.end(), azimuth_rad_[col]);
    const int beam = std::clamp(static_cast<int>(above - beam_edges_rad_.begin()) - 1, 0, beams - 1);
    beam_of_column_.push_back(beam);
    rays_per_beam_[beam] += rows_;
  }
}

Eigen::Vector3f RayFan::Direction(int row, int col) const {
  if (sampling_ == Sampling::kFrustum) {
    return Eigen::Vector3d(column_sine_[col] / column_cosine_[col], 1.0, row_slope_[row])
        .normalized()
        .cast<float>();
  }
  return Eigen::Vector3d(column_sine_[col] * row_cosine_[row], column_cosine_[col] * row_cosine_[row],
                         row_sine_[row])
      .cast<float>();
}

void RayFan::RowDirections(int row, const Eigen::Matrix3f& rotation, float* x, float* y, float* z) const {
  const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> by_rows = rotation;
  row_math::Directions(column_x_.data(), column_y_.data(), row_across_[row], row_up_[row], by_rows.data(),
                       cols_, x, y, z);
}

Eigen::Vector3d RayFan::DirectionWithin(int row, int col, double u, double v) const {
  if (sampling_ == Sampling::kFrustum) {
    return Eigen::Vector3d(std::tan(azimuth_rad_[col]) + u * slope_width_, 1.0,
                           row_slope_[row] + v * slope_height_)
        .normalized();
  }
  const double elevation = row_elevation_rad_[row] + v * row_height_rad_[row];
  const double azimuth = azimuth_rad_[col] + u * column_width_rad_[col];
  return {std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
          std::sin(elevation)};
}

double RayFan::ElevationRad(int row, int col) const {
  if (sampling_ == Sampling::kBeams) return row_elevation_rad_[row];
  return std::atan(row_slope_[row] * column_cosine_[col]);
}

double RayFan::SolidAngleSr(int row, int col) const {
  if (sampling_ == Sampling::kFrustum) {
    // A cell of the plane at unit distance, seen along a ray of length l: area x (1 / l) / l^2.
    const double tangent = column_sine_[col] / column_cosine_[col];
    const double length = std::sqrt(1.0 + tangent * tangent + row_slope_[row] * row_slope_[row]);
    return slope_width_ * slope_height_ / (length * length * length);
  }
  return column_width_rad_[col] * row_sine_height_[row];
}

}  // namespace sonarcal
