#include "calib/parameters/axis_move.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/parameters/pose_step.h"
#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

// Position in a sequence of ascending values, in units of its elements, within the sequence.
double PlaceIn(const std::vector<double>& ascending, double value) {
  const auto above = std::ranges::upper_bound(ascending, value);
  if (above == ascending.begin()) return 0.0;
  const auto i = static_cast<std::size_t>(above - ascending.begin()) - 1;
  if (i + 1 >= ascending.size()) return static_cast<double>(ascending.size() - 1);
  return static_cast<double>(i) + (value - ascending[i]) / (ascending[i + 1] - ascending[i]);
}

std::vector<double> RangesM(const PolarAxes& axes) {
  std::vector<double> ranges_m;
  for (int bin = 0; bin < axes.range_bins; ++bin) ranges_m.push_back(axes.range_centre_m(bin));
  return ranges_m;
}

// Places of the values `to` in the sequence `from`.
std::vector<double> Places(const std::vector<double>& from, const std::vector<double>& to) {
  std::vector<double> places;
  places.reserve(to.size());
  for (const double value : to) places.push_back(PlaceIn(from, value));
  return places;
}

}  // namespace

bool ChangesAxes(const CatalogEntry& entry) {
  return entry.group == ParameterGroup::kGeometry && !entry.name.ends_with("tilt_deg");
}

double PlacementDifference(const PolarAxes& declared, const CatalogEntry& entry) {
  constexpr double kScaleOfObject = 0.005;
  if (entry.group == ParameterGroup::kPose || entry.group == ParameterGroup::kObject)
    return entry.index < kPoseSteps ? PoseDifference(declared, entry.index) : kScaleOfObject;
  const double along_range_m = PoseDifference(declared, 0);
  const double across_deg = PoseDifference(declared, 3);
  if (entry.name.ends_with("range_offset_m")) return along_range_m;
  if (entry.name.ends_with("range_scale")) return along_range_m / declared.range_max_m;
  if (entry.unit == "deg") return across_deg;
  return across_deg / DegFromRad(declared.OuterEdgeRad());
}

template <typename T>
Grid<T> WithAxesMoved(const Grid<T>& image, const PolarAxes& declared, const SonarGeometry& from,
                      const SonarGeometry& to) {
  const PolarAxes axes = Corrected(declared, from);
  const PolarAxes moved = Corrected(declared, to);
  const std::vector<double> rows = Places(RangesM(axes), RangesM(moved));
  const std::vector<double> cols = Places(axes.beam_azimuth_rad, moved.beam_azimuth_rad);
  Grid<T> result(image.rows(), image.cols());
  for (int row = 0; row < image.rows(); ++row) {
    const int r = static_cast<int>(rows[row]);
    const int next_r = std::min(r + 1, image.rows() - 1);
    const double down = rows[row] - r;
    for (int col = 0; col < image.cols(); ++col) {
      const int c = static_cast<int>(cols[col]);
      const int next_c = std::min(c + 1, image.cols() - 1);
      const double right = cols[col] - c;
      result(row, col) =
          static_cast<T>((1.0 - down) * ((1.0 - right) * image(r, c) + right * image(r, next_c)) +
                         down * ((1.0 - right) * image(next_r, c) + right * image(next_r, next_c)));
    }
  }
  return result;
}

template Grid<double> WithAxesMoved(const Grid<double>&, const PolarAxes&, const SonarGeometry&,
                                    const SonarGeometry&);
template Grid<float> WithAxesMoved(const Grid<float>&, const PolarAxes&, const SonarGeometry&,
                                   const SonarGeometry&);

}  // namespace sonarcal::calib
