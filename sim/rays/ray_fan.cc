#include "sim/rays/ray_fan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/rays/row_math/directions.h"

namespace sonarcal::sim {
namespace {

constexpr double kWidestPinholeDeg = 85.0;
constexpr double kMaxRays = 200e6;

// Throws DataError if a fan has too many rays. The number of columns is a double, because a margin may add
// more of them than an integer holds.
void CheckRayCount(double cols, int rows) {
  if (cols * rows > kMaxRays) throw DataError("rays: {} x {} is more than 200 million", cols, rows);
}

// One value in -1/2 .. 1/2 for each of `count`, by golden sections: any run of neighbours is spread evenly.
std::vector<double> GoldenSections(int count) {
  std::vector<double> parts;
  for (int i = 0; i < count; ++i) {
    const double turns = (i + 0.5) * (std::numbers::phi - 1.0);
    parts.push_back(turns - std::floor(turns) - 0.5);
  }
  return parts;
}

}  // namespace

void RayFanOptions::Check() const {
  if (cols < 1 || cols > kMaxCols) throw DataError("rays: {} columns, expected 1 .. {}", cols, kMaxCols);
  if (rows < 1 || rows > kMaxRows) throw DataError("rays: {} rows, expected 1 .. {}", rows, kMaxRows);
  CheckRayCount(cols, rows);
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

  span_rad_ = span_rad;
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
    // A level line in a pinhole image bends towards the centre. With solid-angle weights, the outer beams
    // cover the full elevation too.
    const bool all_of_span = options.weight == RayWeight::kSolidAngle;
    const double outermost = all_of_span ? std::min(std::cos(left_rad), std::cos(right_rad)) : 1.0;
    const double top = std::tan(0.5 * span_rad) / outermost;
    for (int col = 0; col < cols_; ++col) {
      azimuth_rad_.push_back(std::atan(left + (col + 0.5) * (right - left) / cols_));
    }
    for (int row = 0; row < rows_; ++row) row_slope_.push_back(top - (row + 0.5) * 2.0 * top / rows_);
    slope_width_ = (right - left) / cols_;
    slope_height_ = 2.0 * top / rows_;
  } else {
    cols_per_beam_ = (options.cols + beams - 1) / beams;
    // Columns of the margin are as wide as the nearest column within the beams.
    const double left_width = (beam_edges_rad_[1] - beam_edges_rad_[0]) / cols_per_beam_;
    const double right_width = (beam_edges_rad_[beams] - beam_edges_rad_[beams - 1]) / cols_per_beam_;
    const auto margin_cols = [&](double width) { return std::ceil(margin_rad / width - 1e-9); };
    CheckRayCount(
        margin_cols(left_width) + static_cast<double>(cols_per_beam_) * beams + margin_cols(right_width),
        rows_);
    const auto add_margin = [&](double edge_rad, double width, bool left) {
      const int count = static_cast<int>(margin_cols(width));
      for (int i = 0; i < count; ++i) {
        azimuth_rad_.push_back(left ? edge_rad - (count - i - 0.5) * width : edge_rad + (i + 0.5) * width);
        column_width_rad_.push_back(width);
      }
    };
    add_margin(beam_edges_rad_[0], left_width, true);
    for (int beam = 0; beam < beams; ++beam) {
      const double width = (beam_edges_rad_[beam + 1] - beam_edges_rad_[beam]) / cols_per_beam_;
      for (int i = 0; i < cols_per_beam_; ++i) {
        azimuth_rad_.push_back(beam_edges_rad_[beam] + (i + 0.5) * width);
        column_width_rad_.push_back(width);
      }
    }
    add_margin(beam_edges_rad_[beams], right_width, false);
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
    row_sine_half_height_.push_back(std::sin(half_height));
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

  if ((options.stagger || options.stagger_rows) && pinhole)
    throw DataError("rays: only the sampling 'beams' can be staggered");
  if (options.stagger) stagger_ = GoldenSections(rows_);
  if (options.stagger_rows) {
    const std::vector<double> elevation_offset = GoldenSections(cols_);
    elevation_offset_.assign(elevation_offset.begin(), elevation_offset.end());
  }
  stagger_width_rad_.assign(column_width_rad_.begin(), column_width_rad_.end());

  rays_per_beam_.assign(beams, 0);
  for (int col = 0; col < cols_; ++col) {
    const int beam = std::clamp(sonar.axes.BeamAt(azimuth_rad_[col]), 0, beams - 1);
    beam_of_column_.push_back(beam);
    rays_per_beam_[beam] += rows_;
  }
  if (options.weight == RayWeight::kSolidAngle) WeighBySolidAngle();
}

// Weights by solid angle. kBeams: a column counts by its width relative to the mean of its beam, a cell by
// its height relative to the mean row.
void RayFan::WeighBySolidAngle() {
  const double rows_per_rad = rows_ / span_rad_;
  if (sampling_ == Sampling::kBeams) {
    const auto highest = std::max_element(row_height_rad_.begin(), row_height_rad_.end());
    const auto lowest = std::min_element(row_height_rad_.begin(), row_height_rad_.end());
    weighs_evenly_ = *highest - *lowest < 1e-9 * *highest;
    largest_weight_ = weighs_evenly_ ? 1.0 : *highest * rows_per_rad;
    return;
  }
  weighs_evenly_ = false;
  const double limit = std::tan(0.5 * span_rad_);
  std::vector<double> width_rad;
  std::vector<double> of_beam(rays_per_beam_.size(), 0.0);
  for (int col = 0; col < cols_; ++col) {
    const double slope = column_sine_[col] / column_cosine_[col];
    width_rad.push_back(std::atan(slope + 0.5 * slope_width_) - std::atan(slope - 0.5 * slope_width_));
    of_beam[beam_of_column_[col]] += width_rad.back();
  }
  double largest = 0.0;
  for (int col = 0; col < cols_; ++col) {
    const int beam = beam_of_column_[col];
    const double columns = static_cast<double>(rays_per_beam_[beam]) / rows_;
    const double weight = width_rad[col] * columns / of_beam[beam] * rows_per_rad;
    largest = std::max(largest, weight);
    column_weight_.push_back(static_cast<float>(weight));
    column_near_.push_back(static_cast<float>(column_cosine_[col]));
    slope_limit_.push_back(static_cast<float>(limit / column_cosine_[col]));
  }
  // Upper bound: an angle is less than its tangent, which is greatest where the plane is nearest.
  largest_weight_ = largest * slope_height_;
}

void RayFan::RowWeights(int row, float* weight) const {
  if (weighs_evenly_) {
    std::fill_n(weight, cols_, 1.0F);
  } else if (sampling_ == Sampling::kBeams) {
    std::fill_n(weight, cols_, static_cast<float>(row_height_rad_[row] * rows_ / span_rad_));
  } else {
    row_math::CellWeights(column_near_.data(), slope_limit_.data(), column_weight_.data(),
                          static_cast<float>(row_slope_[row]), static_cast<float>(slope_height_), cols_,
                          weight);
  }
}

Eigen::Vector3f RayFan::Direction(int row, int col) const {
  if (sampling_ == Sampling::kFrustum) {
    return Eigen::Vector3d(column_sine_[col] / column_cosine_[col], 1.0, row_slope_[row])
        .normalized()
        .cast<float>();
  }
  const double sine = staggered() ? std::sin(AzimuthRad(row, col)) : column_sine_[col];
  const double cosine = staggered() ? std::cos(AzimuthRad(row, col)) : column_cosine_[col];
  const double across = elevation_offset_.empty() ? row_cosine_[row] : std::cos(ElevationRad(row, col));
  const double up = elevation_offset_.empty() ? row_sine_[row] : std::sin(ElevationRad(row, col));
  return Eigen::Vector3d(sine * across, cosine * across, up).cast<float>();
}

void RayFan::RowDirections(int row, int first, int count, const Eigen::Matrix3f& rotation, float* x, float* y,
                           float* z) const {
  const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> by_rows = rotation;
  const float part = staggered() ? static_cast<float>(stagger_[row]) : 0.0F;
  const float* right = column_x_.data() + first;
  const float* ahead = column_y_.data() + first;
  if (!elevation_offset_.empty()) {
    row_math::TurnedAndRaisedDirections(right, ahead, stagger_width_rad_.data() + first, part,
                                        elevation_offset_.data() + first,
                                        static_cast<float>(row_height_rad_[row]), row_across_[row],
                                        row_up_[row], by_rows.data(), count, x, y, z);
  } else if (staggered()) {
    row_math::TurnedDirections(right, ahead, stagger_width_rad_.data() + first, part, row_across_[row],
                               row_up_[row], by_rows.data(), count, x, y, z);
  } else {
    row_math::Directions(right, ahead, row_across_[row], row_up_[row], by_rows.data(), count, x, y, z);
  }
}

void RayFan::RowAzimuths(int row, float* azimuth_rad) const {
  const double part = staggered() ? stagger_[row] : 0.0;
  const double* middle = azimuth_rad_.data();
  if (part == 0.0) {
    for (int col = 0; col < cols_; ++col) azimuth_rad[col] = static_cast<float>(middle[col]);
    return;
  }
  const double* width = column_width_rad_.data();
  for (int col = 0; col < cols_; ++col)
    azimuth_rad[col] = static_cast<float>(middle[col] + part * width[col]);
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
  if (sampling_ == Sampling::kBeams) return row_elevation_rad_[row] + ElevationOffsetRad(row, col);
  return std::atan(row_slope_[row] * column_cosine_[col]);
}

double RayFan::SpreadHeightRad(int row, int col) const {
  if (sampling_ == Sampling::kFrustum) return std::sqrt(SolidAngleSr(row, col));
  return row_height_rad_[row] / (elevation_offset_.empty() ? 1 : cols_per_beam_);
}

double RayFan::SolidAngleSr(int row, int col) const {
  if (sampling_ == Sampling::kFrustum) {
    // Solid angle of a cell of the plane at unit distance, seen along a ray of length l: area x (1 / l) /
    // l^2.
    const double tangent = column_sine_[col] / column_cosine_[col];
    const double length = std::sqrt(1.0 + tangent * tangent + row_slope_[row] * row_slope_[row]);
    return slope_width_ * slope_height_ / (length * length * length);
  }
  // Cell about the ray: cos(elevation) = cos(e) cos(r) - sin(e) sin(r) for a row at e and an elevation offset
  // r.
  const double offset_rad = ElevationOffsetRad(row, col);
  const double cosine = offset_rad == 0.0
                            ? row_cosine_[row]
                            : row_cosine_[row] * std::cos(offset_rad) - row_sine_[row] * std::sin(offset_rad);
  return column_width_rad_[col] * 2.0 * row_sine_half_height_[row] * cosine;
}

}  // namespace sonarcal::sim
