// Rays that represent a sonar's beams: a regular grid of directions in the sonar frame.
//
// Sampling:
//
//   frustum  Depth camera of the paper (Park 2024 Section 3.1): a pinhole grid over the field of view, pixel
//            centres at half-integers. Horizontally it reaches from the outer edge of the first beam to that
//            of the last.
//   beams    Equal angles over each beam's azimuth interval and over elevation, like an array. Needs fewer
//            rays for the same image; the default for calibration. Rows may be denser at the horizon, where a
//            small angle covers a long distance on the floor.
//
// A margin adds columns beyond the outer edges of the outer beams. Their echoes enter through the flanks and
// side lobes of those beams. Only models with beam patterns need a margin; a model that assigns each ray to
// one beam does not.
//
// In both samplings, all rays of a grid column have the same azimuth, unless the fan is staggered. Ray index
// = row * cols + col; row 0 has the highest elevation.
//
// Weight of a ray in a model that sums over the rays of a beam, such as the paper's (a model that uses solid
// angles computes its own weights):
//
//   even         Each ray of a beam has the same weight, as in the paper's Eq. 22. The rows of a pinhole are
//                denser away from its centre and end lower in the outer beams, so its image differs from that
//                of even angles.
//   solid_angle  Azimuth and elevation covered by the ray's cell, relative to a cell of even angles at the
//                same elevation: 1 on average over a beam. A pinhole then covers the full elevation in its
//                outer beams too, and a cell counts by the part within the elevation span, so both samplings
//                give the same image. Rays at even angles have weight 1 in both cases.
#pragma once

#include <Eigen/Core>
#include <type_traits>
#include <vector>

#include "core/types/sonar_model.h"
#include "core/types/words.h"

namespace sonarcal::sim {

enum class Sampling { kFrustum, kBeams };
constexpr auto WordsOf(std::type_identity<Sampling>) {
  return Words<Sampling, 2>{{{"frustum", Sampling::kFrustum}, {"beams", Sampling::kBeams}}};
}
enum class RayWeight { kEven, kSolidAngle };
constexpr auto WordsOf(std::type_identity<RayWeight>) {
  return Words<RayWeight, 2>{{{"even", RayWeight::kEven}, {"solid_angle", RayWeight::kSolidAngle}}};
}

struct RayFanOptions {
  static constexpr int kMaxCols = 100'000;
  static constexpr int kMaxRows = 100'000;

  Sampling sampling = Sampling::kFrustum;
  int cols = 1500;  // columns over the horizontal field of view; kBeams: rounded up to whole columns per beam
  int rows = 1200;  // rows over the vertical field of view
  double elevation_span_deg = 0.0;  // vertical field of view; 0 = the sonar's elevation beam width
  // Azimuth cast beyond each outer edge, at most 60. kFrustum: the same number of columns covers the margin
  // too. kBeams: adds columns of the outer beam's column width.
  double azimuth_margin_deg = 0.0;
  // kBeams: mean height of a row divided by the height at the horizon, 1 (even) .. 100. With u = -1..1 down
  // the rows, elevation is span / 2 x (u / crowding + (1 - 1 / crowding) u^3).
  double row_crowding = 1.0;
  RayWeight weight = RayWeight::kEven;
  // kBeams: shifts the rays of each row within the width of their columns, by golden sections. A vertical
  // edge then changes the result by at most one or two rays, however many rows see it; without stagger by up
  // to half of the rays. For a model that blurs whole columns, a ray still represents the column's width.
  bool stagger = false;
  // kBeams: shifts the rays of each column within the height of their rows, by golden sections. Level edges,
  // and the lines that rows draw on a distant floor, then move smoothly with the sonar.
  bool stagger_rows = false;

  // Throws DataError that names the field, its value and the limit.
  void Check() const;
};

class RayFan {
 public:
  // Throws DataError if the fan cannot cover the sonar's field of view (a pinhole must stay within +-85
  // degrees), or if it has more than 200 million rays, those of the margin included.
  RayFan(const SonarModel& sonar, const RayFanOptions& options);

  int rows() const { return rows_; }
  int cols() const { return cols_; }
  int size() const { return rows_ * cols_; }
  Sampling sampling() const { return sampling_; }

  // Unit vector in the sonar frame (X right, Y forward, Z up).
  Eigen::Vector3f Direction(int row, int col) const;
  // Directions of a row from column `first` on, in single precision, rotated by `rotation`.
  void RowDirections(int row, int first, int count, const Eigen::Matrix3f& rotation, float* x, float* y,
                     float* z) const;
  // Directions of the whole row; arrays of cols().
  void RowDirections(int row, const Eigen::Matrix3f& rotation, float* x, float* y, float* z) const {
    RowDirections(row, 0, cols_, rotation, x, y, z);
  }
  double AzimuthRad(int col) const { return azimuth_rad_[col]; }  // middle of the column
  double AzimuthRad(int row, int col) const { return azimuth_rad_[col] + AzimuthOffsetRad(row, col); }
  bool staggered() const { return !stagger_.empty(); }  // in azimuth
  // Azimuths of a whole row in single precision; an array of cols().
  void RowAzimuths(int row, float* azimuth_rad) const;
  double ElevationRad(int row, int col) const;
  double SolidAngleSr(int row, int col) const;
  // Elevation over which the echo of a ray is spread: the height of its row. If rows are staggered, the
  // columns of a beam share that height, because they lie at different elevations. kFrustum: that of a
  // square cell.
  double SpreadHeightRad(int row, int col) const;

  // kBeams: a ray's elevation is RowElevationRad + RowHeightRad x ElevationOffset(col), with an offset in
  // -1/2 .. 1/2. Its solid angle is ColumnWidthRad x RowHeight x cos(elevation).
  double RowElevationRad(int row) const { return row_elevation_rad_[row]; }
  double RowHeightRad(int row) const { return row_height_rad_[row]; }
  double RowHeight(int row) const { return 2.0 * row_sine_half_height_[row]; }
  double ColumnWidthRad(int col) const { return column_width_rad_[col]; }
  float ElevationOffset(int col) const { return elevation_offset_.empty() ? 0.0F : elevation_offset_[col]; }

  // Weights of the rays of a row, relative to an even share of their beam (see RayWeight); an array of
  // cols().
  void RowWeights(int row, float* weight) const;
  // True if all weights are 1.
  bool weighs_evenly() const { return weighs_evenly_; }
  // Upper bound of all weights.
  double largest_weight() const { return largest_weight_; }

  // Unit vector to a point of the ray's cell: u to the right, v up, each -1/2..1/2 across the cell. Even
  // steps of u and v are even in solid angle, to first order in the cell's size.
  Eigen::Vector3d DirectionWithin(int row, int col, double u, double v) const;

  // Beam whose interval holds the column's azimuth (for the margin: the outer beam), and total number of rays
  // per beam.
  int BeamOfColumn(int col) const { return beam_of_column_[col]; }
  const std::vector<int>& rays_per_beam() const { return rays_per_beam_; }
  const std::vector<double>& beam_edges_rad() const { return beam_edges_rad_; }

 private:
  void WeighBySolidAngle();
  double AzimuthOffsetRad(int row, int col) const {
    return stagger_.empty() ? 0.0 : stagger_[row] * column_width_rad_[col];
  }
  double ElevationOffsetRad(int row, int col) const {
    return elevation_offset_.empty() ? 0.0 : elevation_offset_[col] * row_height_rad_[row];
  }

  Sampling sampling_;
  int rows_;
  int cols_;
  int cols_per_beam_ = 1;  // kBeams
  std::vector<double> beam_edges_rad_;
  std::vector<double> azimuth_rad_;       // per column
  std::vector<double> column_width_rad_;  // kBeams: azimuth interval of a column
  std::vector<int> beam_of_column_;
  std::vector<int> rays_per_beam_;
  // kFrustum: vertical slope of each row.
  std::vector<double> row_slope_;
  double slope_width_ = 0.0;  // kFrustum: sides of a pixel on the plane at unit distance
  double slope_height_ = 0.0;
  double span_rad_ = 0.0;
  bool weighs_evenly_ = true;
  double largest_weight_ = 1.0;
  // kFrustum by solid angle, per column: weight of one radian of elevation; cosine of the azimuth; slope at
  // which the elevation span ends.
  std::vector<float> column_weight_;
  std::vector<float> column_near_;
  std::vector<float> slope_limit_;
  std::vector<double> row_elevation_rad_;
  std::vector<double> row_height_rad_;  // kBeams
  // Sines and cosines of azimuths and (kBeams) elevations.
  std::vector<double> column_sine_;
  std::vector<double> column_cosine_;
  std::vector<double> row_sine_;
  std::vector<double> row_cosine_;
  std::vector<double> row_sine_half_height_;
  // Directions before normalisation: (across x[col], across y[col], up), with `across` and `up` of the row.
  std::vector<float> column_x_;
  std::vector<float> column_y_;
  std::vector<float> row_across_;
  std::vector<float> row_up_;
  std::vector<double> stagger_;  // per row, in units of the column's width, -1/2 .. 1/2; empty: all 0
  std::vector<float> stagger_width_rad_;
  std::vector<float>
      elevation_offset_;  // per column, in units of the row's height, -1/2 .. 1/2; empty: all 0
};

}  // namespace sonarcal::sim
