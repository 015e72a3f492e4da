// The rays that stand for a sonar's beams: a regular grid of directions in the sonar frame.
//
//   frustum  the paper's depth camera (Park 2024 Section 3.1): a pinhole grid over the field of view, pixel
//            centres at half-integers. Horizontally from the outer edge of the first beam to that of the
//            last.
//   beams    equal angles over each beam's azimuth interval and over elevation: what an array does; fewer
//            rays for the same image, and the default for calibration. Rows may crowd about the horizon,
//            where a small angle is a long way on the floor.
//
// A margin adds columns beyond the outer edges of the outer beams: what lies there is in those beams' flanks
// and side lobes. It is for models that have them; one that gives each ray to the beam it falls in needs
// none.
//
// In both, every ray of a grid column has the same azimuth, unless the fan is staggered. Ray index = row *
// cols + col; row 0 looks highest.
//
// What a ray counts, to a model that sums over the rays of a beam (the paper's; one that takes solid angles
// weighs them itself):
//
//   even         each ray of a beam alike, as in the paper's Eq. 22. A pinhole's rows crowd away from its
//                centre and end lower in the outer beams, so its image is not that of even angles.
//   solid_angle  each by its solid angle over that of even angles at its elevation: by the azimuth and
//                elevation that its cell covers, 1 on average over a beam. A pinhole then reaches the full
//                elevation in its outer beams too, and a cell counts by as much of it as lies within: both
//                samplings come to one image. Even angles weigh 1 either way.
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
  Sampling sampling = Sampling::kFrustum;
  int cols = 1500;  // over the horizontal field of view; for kBeams rounded up to whole columns a beam
  int rows = 1200;  // over the vertical field of view
  double elevation_span_deg = 0.0;  // vertical field of view; 0 = the sonar's elevation beam width
  // Azimuth cast beyond either outer edge. kFrustum: the same number of columns covers it too; kBeams: as
  // many more columns as it takes, of the outer beam's width. Up to 60.
  double azimuth_margin_deg = 0.0;
  // kBeams: mean height of a row over that at the horizon, 1 (even) .. 100. With u = -1..1 down the rows,
  // elevation is span / 2 x (u / crowding + (1 - 1 / crowding) u^3).
  double row_crowding = 1.0;
  RayWeight weight = RayWeight::kEven;
  // kBeams: each row's rays stand elsewhere in the width of their columns, as golden sections spread them. An
  // upright edge then costs no more than a ray or two in however many rows see it, where in columns that
  // stand alike it costs up to half of one. To a model that blurs whole columns each stands for its width.
  bool stagger = false;
  // kBeams: likewise, each column's rays stand elsewhere in the height of their rows. Level edges move evenly
  // with the sonar then, and so do the lines that rows draw on a floor far away.
  bool stagger_rows = false;

  // Throws DataError naming field, value and limit.
  void Check() const;
};

class RayFan {
 public:
  // Throws DataError where the sonar's field of view cannot be covered (a pinhole needs less than +-85
  // degrees).
  RayFan(const SonarModel& sonar, const RayFanOptions& options);

  int rows() const { return rows_; }
  int cols() const { return cols_; }
  int size() const { return rows_ * cols_; }
  Sampling sampling() const { return sampling_; }

  // Unit vector in the sonar frame (X right, Y forward, Z up).
  Eigen::Vector3f Direction(int row, int col) const;
  // The directions of a row from column `first` on, in single precision, turned by `rotation`.
  void RowDirections(int row, int first, int count, const Eigen::Matrix3f& rotation, float* x, float* y,
                     float* z) const;
  // Of the whole row; arrays of cols().
  void RowDirections(int row, const Eigen::Matrix3f& rotation, float* x, float* y, float* z) const {
    RowDirections(row, 0, cols_, rotation, x, y, z);
  }
  double AzimuthRad(int col) const { return azimuth_rad_[col]; }  // of the column's middle
  double AzimuthRad(int row, int col) const { return azimuth_rad_[col] + AsideRad(row, col); }
  bool staggered() const { return !stagger_.empty(); }  // in azimuth
  // Azimuths of a whole row in single precision; an array of cols().
  void RowAzimuths(int row, float* azimuth_rad) const;
  double ElevationRad(int row, int col) const;
  double SolidAngleSr(int row, int col) const;

  // kBeams: a ray's elevation is RowElevationRad + RowHeightRad x its column's part (raise), -1/2 .. 1/2, and
  // its solid angle ColumnWidthRad x RowHeight x cos(elevation).
  double RowElevationRad(int row) const { return row_elevation_rad_[row]; }
  double RowHeightRad(int row) const { return row_height_rad_[row]; }
  double RowHeight(int row) const { return 2.0 * row_sine_half_height_[row]; }
  double ColumnWidthRad(int col) const { return column_width_rad_[col]; }
  float Raise(int col) const { return raise_.empty() ? 0.0F : raise_[col]; }

  // What the rays of a row count beside an even share of their beam, as the options say; an array of cols().
  void RowWeights(int row, float* weight) const;
  // All of them 1: nobody needs to ask.
  bool weighs_evenly() const { return weighs_evenly_; }
  // None counts more.
  double largest_weight() const { return largest_weight_; }

  // Unit vector to a point of the ray's cell: u to the right and v up, -1/2..1/2 each across the cell. Even
  // steps of u and v are even in solid angle to first order in the cell's size.
  Eigen::Vector3d DirectionWithin(int row, int col, double u, double v) const;

  // The beam whose interval holds the column's azimuth (of the margin: the outer beam), and how many rays
  // each beam has in all.
  int BeamOfColumn(int col) const { return beam_of_column_[col]; }
  const std::vector<int>& rays_per_beam() const { return rays_per_beam_; }
  const std::vector<double>& beam_edges_rad() const { return beam_edges_rad_; }

 private:
  void WeighBySolidAngle();
  double AsideRad(int row, int col) const {
    return stagger_.empty() ? 0.0 : stagger_[row] * column_width_rad_[col];
  }
  double RaisedRad(int row, int col) const {
    return raise_.empty() ? 0.0 : raise_[col] * row_height_rad_[row];
  }

  Sampling sampling_;
  int rows_;
  int cols_;
  std::vector<double> beam_edges_rad_;
  std::vector<double> azimuth_rad_;       // one a column
  std::vector<double> column_width_rad_;  // kBeams: azimuth interval of a column
  std::vector<int> beam_of_column_;
  std::vector<int> rays_per_beam_;
  // kFrustum: slopes, tan(azimuth) of each column and the vertical slope of each row; kBeams: elevations.
  std::vector<double> row_slope_;
  double slope_width_ = 0.0;  // kFrustum: sides of a pixel on the plane at unit distance
  double slope_height_ = 0.0;
  double span_rad_ = 0.0;
  bool weighs_evenly_ = true;
  double largest_weight_ = 1.0;
  // kFrustum by solid angle, one a column: of a radian of elevation; cosine of the azimuth; slope at which
  // the elevation ends.
  std::vector<float> column_weight_;
  std::vector<float> column_near_;
  std::vector<float> slope_limit_;
  std::vector<double> row_elevation_rad_;
  std::vector<double> row_height_rad_;  // kBeams
  // Of azimuths and (kBeams) elevations, once for all rays.
  std::vector<double> column_sine_;
  std::vector<double> column_cosine_;
  std::vector<double> row_sine_;
  std::vector<double> row_cosine_;
  std::vector<double> row_sine_half_height_;
  // Directions but for their length: (across x[col], across y[col], up), `across` and `up` of the row.
  std::vector<float> column_x_;
  std::vector<float> column_y_;
  std::vector<float> row_across_;
  std::vector<float> row_up_;
  std::vector<double> stagger_;  // of each row, of a column's width, -1/2 .. 1/2; empty: all 0
  std::vector<float> stagger_width_rad_;
  std::vector<float> raise_;  // of each column, of a row's height, likewise
};

}  // namespace sonarcal::sim
