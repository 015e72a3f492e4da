// Images with their axes and the meaning of their values.
//
// PolarImage: row = range bin (row 0 nearest), column = beam (column 0 leftmost, most negative azimuth).
// FanImage:   row 0 farthest (so that the picture shows ahead as up), column 0 leftmost, square pixels in
//             metres, x to the right and y ahead of the sonar; pixels outside the fan are masked.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/types/error.h"

namespace sonarcal {

// Row-major two-dimensional array.
template <typename T>
class Grid {
 public:
  Grid() = default;
  Grid(int rows, int cols, T fill = T{}) : rows_(rows), cols_(cols) {
    SONARCAL_CHECK(rows >= 0 && cols >= 0, "grid of {} x {}", rows, cols);
    values_.assign(static_cast<std::size_t>(rows) * cols, fill);
  }

  int rows() const { return rows_; }
  int cols() const { return cols_; }
  std::size_t size() const { return values_.size(); }
  bool empty() const { return values_.empty(); }

  T& operator()(int row, int col) { return values_[static_cast<std::size_t>(row) * cols_ + col]; }
  const T& operator()(int row, int col) const { return values_[static_cast<std::size_t>(row) * cols_ + col]; }

  std::span<T> row(int row) { return {&values_[static_cast<std::size_t>(row) * cols_], std::size_t(cols_)}; }
  std::span<const T> row(int row) const {
    return {&values_[static_cast<std::size_t>(row) * cols_], std::size_t(cols_)};
  }

  std::span<T> values() & { return values_; }
  std::span<const T> values() const& { return values_; }
  // Values of a temporary, which outlive it.
  std::vector<T> values() && { return std::move(values_); }

  bool operator==(const Grid&) const = default;

 private:
  int rows_ = 0;
  int cols_ = 0;
  std::vector<T> values_;
};

// Positions of the pixels of a polar image.
struct PolarAxes {
  double range_min_m = 0.0;
  double range_max_m = 0.0;
  int range_bins = 0;
  std::vector<double> beam_azimuth_rad;  // centres, strictly ascending (positive to the right)

  int beam_count() const { return static_cast<int>(beam_azimuth_rad.size()); }
  double range_bin_m() const { return (range_max_m - range_min_m) / range_bins; }
  // Mean angle between neighbouring centres; 0 for a single beam.
  double beam_spacing_rad() const {
    return (beam_azimuth_rad.back() - beam_azimuth_rad.front()) / std::max(1, beam_count() - 1);
  }
  double range_centre_m(int bin) const { return range_min_m + (bin + 0.5) * range_bin_m(); }
  // Near edge of a bin; edge range_bins is the far edge of the last bin.
  double range_edge_m(int edge) const { return range_min_m + edge * range_bin_m(); }

  // Left edge of a beam, 0 .. beam_count(), midway between centres. The two outer edges are as far from their
  // centre as the next inner ones. Needs at least two beams.
  double BeamEdgeRad(int edge) const;
  // All beam_count() + 1 edges.
  std::vector<double> BeamEdgesRad() const;
  // From the left edge of the first beam to the right edge of the last.
  double field_of_view_rad() const { return BeamEdgeRad(beam_count()) - BeamEdgeRad(0); }
  // Larger of the absolute azimuths of the two outer edges.
  double OuterEdgeRad() const { return std::max(-BeamEdgeRad(0), BeamEdgeRad(beam_count())); }

  // Bin that contains a range, its near edge included. -1 for a range nearer than the window, range_bins for
  // one beyond it.
  int BinAt(double range_m) const;
  // Beam that contains an azimuth, its left edge included. -1 for an azimuth to the left of all beams,
  // beam_count() for one to the right.
  int BeamAt(double azimuth_rad) const;

  // True if the geometry agrees to within a thousandth of a bin and of a beam. Otherwise `why`, if given,
  // receives the difference.
  bool Matches(const PolarAxes& other, std::string* why = nullptr) const;

  // Throws DataError, naming `what`, if the axes are not finite, ordered and of positive size.
  void Validate(const std::string& what) const;
};

// Quantity of an image's values. Images of different quantities are never compared.
enum class Quantity {
  kGrey,     // display value, 0 .. full_scale
  kDecibel,  // level in dB
  kPower,    // linear power
  kDepth,    // metres
};

std::string_view ToString(Quantity quantity);

// Meaning of the values of an image.
struct ImageScale {
  Quantity quantity = Quantity::kGrey;
  double full_scale = 255.0;     // largest possible value of a kGrey pixel: 255, 4095 or 65535
  std::optional<double> db_min;  // level displayed as 0, if known
  std::optional<double> db_max;  // level displayed as full_scale, if known
  // db_max - db_min, if only the difference is known, e.g. after a viewer stretched the grey values.
  std::optional<double> db_span;

  bool operator==(const ImageScale&) const = default;
};

struct PolarImage {
  PolarAxes axes;
  ImageScale scale;
  Grid<float> value;  // range_bins x beam_count
};

// Positions of the pixels of a fan image: pixel centre (row, col) is at x = x_min_m + (col + 0.5) pixel_m, y
// = y_max_m - (row + 0.5) pixel_m.
struct FanAxes {
  int rows = 0;
  int cols = 0;
  double pixel_m = 0.0;
  double x_min_m = 0.0;
  double y_max_m = 0.0;

  double x_m(int col) const { return x_min_m + (col + 0.5) * pixel_m; }
  double y_m(int row) const { return y_max_m - (row + 0.5) * pixel_m; }
  bool operator==(const FanAxes&) const = default;
};

struct FanImage {
  FanAxes axes;
  ImageScale scale;
  Grid<float> value;          // 0 outside the fan
  Grid<std::uint8_t> inside;  // 1 inside the fan
};

}  // namespace sonarcal
