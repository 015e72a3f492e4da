#include "apps/reproduce/marked_surface.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/images/image_io.h"

namespace sonarcal::reproduce {
namespace {

constexpr double kMaxLeanDeg = 80.0;
constexpr double kElevationStepDeg = 0.25;
constexpr double kBeyondWindow = 1.1;

// Value at 0 of the parabola (a line, where there are but two points) through points (x, y), least squares.
double AtZero(const std::vector<double>& x, const std::vector<double>& y) {
  const auto terms = static_cast<Eigen::Index>(std::min<std::size_t>(3, x.size()));
  Eigen::MatrixXd powers(static_cast<Eigen::Index>(x.size()), terms);
  Eigen::VectorXd values(static_cast<Eigen::Index>(x.size()));
  for (Eigen::Index i = 0; i < powers.rows(); ++i) {
    for (Eigen::Index k = 0; k < terms; ++k) powers(i, k) = std::pow(x[i], static_cast<double>(k));
    values(i) = y[i];
  }
  return powers.colPivHouseholderQr().solve(values)(0);
}

Eigen::Vector3d PointAt(double range_m, double azimuth_rad, double elevation_rad) {
  return range_m * Eigen::Vector3d(std::sin(azimuth_rad) * std::cos(elevation_rad),
                                   std::cos(azimuth_rad) * std::cos(elevation_rad), std::sin(elevation_rad));
}

// Lower and upper end of a beam's strip in elevation.
std::pair<double, double> ElevationsRad(double lean_rad, double half_beam_rad) {
  return {lean_rad > half_beam_rad ? -half_beam_rad : -4.0 * half_beam_rad, 4.0 * half_beam_rad};
}

class StripMaker {
 public:
  StripMaker(const PolarAxes& axes, const MarkedStripOptions& options)
      : lean_rad_(RadFromDeg(options.lean_deg)),
        half_beam_rad_(RadFromDeg(0.5 * options.elevation_deg)),
        farthest_m_(kBeyondWindow * axes.range_max_m) {
    scene_.material_names = {options.material};
    const auto [low, high] = ElevationsRad(lean_rad_, half_beam_rad_);
    const int steps = static_cast<int>(std::ceil((high - low) / RadFromDeg(kElevationStepDeg)));
    for (int i = 0; i <= steps; ++i) elevation_rad_.push_back(low + (high - low) * i / steps);
  }

  // A column of the strip; joined to the one before it.
  void Column(double azimuth_rad, double range_m, bool joined) {
    const int first = static_cast<int>(scene_.vertices_m.size());
    std::vector<bool> near;
    for (const double elevation : elevation_rad_) {
      const double at_m = range_m * StripRangeRatio(lean_rad_, half_beam_rad_, elevation);
      // Never met again beyond where sound and line are parallel.
      near.push_back(at_m > 0.0 && at_m <= farthest_m_);
      scene_.vertices_m.emplace_back(
          PointAt(near.back() ? at_m : farthest_m_, azimuth_rad, elevation).cast<float>());
    }
    for (int i = 0; joined && i + 1 < static_cast<int>(near.size()); ++i) {
      if (!near[i] || !near[i + 1] || !near_before_[i] || !near_before_[i + 1]) continue;
      const int a = first - static_cast<int>(near.size()) + i;  // left, lower
      const int b = first + i;                                  // right, lower
      Triangle(a, b, b + 1);
      Triangle(a, b + 1, a + 1);
    }
    near_before_ = std::move(near);
  }

  Scene Take() && { return std::move(scene_); }

 private:
  void Triangle(int a, int b, int c) {
    scene_.triangles.emplace_back(a, b, c);
    scene_.triangle_material.push_back(0);
  }

  double lean_rad_;
  double half_beam_rad_;
  double farthest_m_;
  std::vector<double> elevation_rad_;
  std::vector<bool> near_before_;
  Scene scene_;
};

}  // namespace

FirstReturn ReadFirstReturn(const std::filesystem::path& file, const PolarAxes& axes) {
  const data_io::ImageFile image(file);
  if (image.header().rows != axes.range_bins || image.header().cols != axes.beam_count()) {
    throw DataError("{}: {}, expected {} x {}, one row a range bin and one column a beam", file.string(),
                    image.header().Describe(), axes.range_bins, axes.beam_count());
  }
  const RgbImage rgb = image.DecodeRgb();
  FirstReturn marks(axes.beam_count());
  for (int beam = 0; beam < axes.beam_count(); ++beam) {
    for (int bin = 0; bin < axes.range_bins && !marks[beam]; ++bin) {
      if (rgb(bin, beam) != std::array<std::uint8_t, 3>{}) marks[beam] = bin;
    }
  }
  return marks;
}

std::vector<std::optional<double>> SmoothedRangesM(const FirstReturn& marks, const PolarAxes& axes) {
  std::vector<std::optional<double>> smoothed(marks.size());
  const int beams = static_cast<int>(marks.size());
  for (int beam = 0; beam < beams; ++beam) {
    if (!marks[beam]) continue;
    // Offsets and ranges of the run of marks that contains this one.
    std::vector<double> offset = {0.0};
    std::vector<double> range_m = {axes.range_centre_m(*marks[beam])};
    for (const int step : {-1, 1}) {
      for (int k = 1; k <= kSmoothBeams / 2; ++k) {
        const int at = beam + step * k;
        if (at < 0 || at >= beams || !marks[at]) break;
        offset.push_back(axes.beam_azimuth_rad[at] - axes.beam_azimuth_rad[beam]);
        range_m.push_back(axes.range_centre_m(*marks[at]));
      }
    }
    smoothed[beam] = AtZero(offset, range_m);
  }
  return smoothed;
}

std::optional<std::string> LeanAtEnd(double lean_deg, double largest_tried_deg) {
  if (lean_deg >= largest_tried_deg) {
    return fmt::format(
        "the strip leans by the largest angle that was tried, {:g} degrees: a larger one may be likelier",
        lean_deg);
  }
  if (lean_deg > 0.0) return std::nullopt;
  return "the strip leans by the least angle that was tried, 0 degrees: leaning the other way looks the "
         "same, but it may also be that no straight strip fits";
}

double StripRangeRatio(double lean_rad, double half_beam_rad, double elevation_rad) {
  const double nearest_rad = -std::min(lean_rad, half_beam_rad);
  return std::cos(nearest_rad + lean_rad) / std::cos(elevation_rad + lean_rad);
}

Scene MakeMarkedStrip(const FirstReturn& marks, const PolarAxes& axes, const MarkedStripOptions& options) {
  if (!(options.lean_deg >= 0.0 && options.lean_deg <= kMaxLeanDeg)) {
    throw DataError("strip from marks: lean_deg is {}, expected 0 .. {}", options.lean_deg, kMaxLeanDeg);
  }
  SONARCAL_CHECK(static_cast<int>(marks.size()) == axes.beam_count(), "{} marks of {} beams", marks.size(),
                 axes.beam_count());
  const std::vector<std::optional<double>> range_m = SmoothedRangesM(marks, axes);
  const std::vector<double>& azimuth = axes.beam_azimuth_rad;
  const int beams = axes.beam_count();
  StripMaker maker(axes, options);
  // At the ends of a run half a beam beyond, on the line through its last two.
  const auto end = [&](int beam, int inner, bool joined) {
    const double out = 0.5 * (azimuth[beam] - azimuth[inner]);
    maker.Column(azimuth[beam] + out, *range_m[beam] + 0.5 * (*range_m[beam] - *range_m[inner]), joined);
  };
  bool any = false;
  for (int beam = 0; beam < beams; ++beam) {
    const bool before = beam > 0 && range_m[beam - 1];
    const bool after = beam + 1 < beams && range_m[beam + 1];
    if (!range_m[beam] || !(before || after)) continue;
    any = true;
    if (!before) end(beam, beam + 1, false);
    maker.Column(azimuth[beam], *range_m[beam], true);
    if (!after) end(beam, beam - 1, true);
  }
  if (!any) throw DataError("strip from marks: no two beams next to each other are marked");
  return std::move(maker).Take();
}

}  // namespace sonarcal::reproduce
