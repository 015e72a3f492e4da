#include "calib/standard_target/target_windows.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "core/math/statistics.h"
#include "core/types/error.h"
#include "sim/physics/beam_pattern.h"

namespace sonarcal::calib {
namespace {

// A sighting with the pixels that may belong to its window.
struct Sighted {
  int frame = 0;
  TargetSighting sighting;
  std::optional<Pose> pose;
  ReceivedPowers powers;
  int first_bin = 0;
  int first_beam = 0;
};

template <typename T>
Grid<T> Cut(const Grid<T>& grid, int first_row, int rows, int first_col, int cols) {
  Grid<T> cut(rows, cols);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) cut(row, col) = grid(first_row + row, first_col + col);
  }
  return cut;
}

// Samples on either side of a peak that belong to its window.
int Reach(double extent, double sample) {
  constexpr double kReachInExtents = 3.0;
  constexpr int kAtLeast = 3;
  return std::max(kAtLeast, static_cast<int>(std::ceil(kReachInExtents * extent / sample)));
}

Sighted CutOut(int frame, const TargetSighting& sighting, const FrameInfo& info, const ReceivedPowers& powers,
               const PolarAxes& axes) {
  constexpr double kMargin = 2.0;  // the median of all extents may be larger than this one
  const int bins = Reach(kMargin * sighting.range_extent_m, axes.range_bin_m());
  const int beams = Reach(kMargin * sighting.azimuth_extent_rad, axes.beam_spacing_rad());
  const int first_bin = std::max(0, sighting.bin - bins);
  const int first_beam = std::max(0, sighting.beam - beams);
  const int rows = std::min(axes.range_bins, sighting.bin + bins + 1) - first_bin;
  const int cols = std::min(axes.beam_count(), sighting.beam + beams + 1) - first_beam;
  return {.frame = frame,
          .sighting = sighting,
          .pose = info.world_from_sonar,
          .powers = {Cut(powers.power, first_bin, rows, first_beam, cols),
                     Cut(powers.rounding_variance, first_bin, rows, first_beam, cols),
                     Cut(powers.clipped, first_bin, rows, first_beam, cols)},
          .first_bin = first_bin,
          .first_beam = first_beam};
}

template <typename Value>
double MedianOf(const std::vector<Sighted>& sighted, const Value& value) {
  std::vector<double> values;
  for (const Sighted& one : sighted) values.push_back(value(one.sighting));
  return Median(std::move(values));
}

// Window of `bins` and `beams` to each side; absent if a pixel is clipped.
std::optional<EchoWindow> WindowOf(const Sighted& sighted, const PolarAxes& axes, int bins, int beams) {
  const Grid<double>& power = sighted.powers.power;
  EchoWindow window;
  window.frame = sighted.frame;
  window.first_bin = std::max(sighted.first_bin, sighted.sighting.bin - bins);
  window.first_beam = std::max(sighted.first_beam, sighted.sighting.beam - beams);
  const int last_bin = std::min(sighted.first_bin + power.rows() - 1, sighted.sighting.bin + bins);
  const int last_beam = std::min(sighted.first_beam + power.cols() - 1, sighted.sighting.beam + beams);
  for (int beam = window.first_beam; beam <= last_beam; ++beam)
    window.beam_azimuth_rad.push_back(axes.beam_azimuth_rad[beam]);
  for (int bin = window.first_bin; bin <= last_bin; ++bin) {
    window.bin_range_m.push_back(axes.range_centre_m(bin));
    for (int beam = window.first_beam; beam <= last_beam; ++beam) {
      const int row = bin - sighted.first_bin;
      const int col = beam - sighted.first_beam;
      if (sighted.powers.clipped(row, col) != 0) return {};
      window.power.push_back(power(row, col));
      window.rounding_variance.push_back(sighted.powers.rounding_variance(row, col));
    }
  }
  return window;
}

}  // namespace

TargetWindows FindTargetWindows(const RecordingSource& recording, const DisplayParameters<double>& display,
                                const TargetSearch& search, std::vector<int> frames,
                                const std::function<void(int done, int total)>& progress) {
  const SonarModel& sonar = recording.info().sonar;
  const PolarAxes& axes = sonar.axes;
  if (axes.beam_count() < 3) {
    throw DataError("{}: the recording has {} beams, expected at least 3", recording.info().source,
                    axes.beam_count());
  }
  if (frames.empty()) {
    frames.resize(recording.frame_count());
    std::iota(frames.begin(), frames.end(), 0);
  }
  TargetWindows result;
  std::vector<Sighted> sighted;
  int done = 0;
  for (const int frame : frames) {
    const Frame read = recording.ReadFrame(frame);
    if (std::string why; !axes.Matches(read.image.axes, &why)) {
      throw DataError("{}: the axes of frame {} are not those of the first frame: {}",
                      recording.info().source, frame, why);
    }
    const ReceivedPowers powers = PowersOf(read.image, display);
    const TargetSearchResult found = FindTarget(powers, axes, search);
    if (found.sighting) {
      sighted.push_back(CutOut(frame, *found.sighting, read.info, powers, axes));
    } else {
      result.left_out.push_back({frame, found.why_not, found.detail});
    }
    if (progress) progress(++done, static_cast<int>(frames.size()));
  }
  if (sighted.empty()) ThrowNoTarget(recording, result.left_out);

  result.range_extent_m = std::max(
      axes.range_bin_m(), MedianOf(sighted, [](const TargetSighting& s) { return s.range_extent_m; }));
  result.azimuth_extent_rad =
      std::max(0.5 * axes.beam_spacing_rad(),
               MedianOf(sighted, [](const TargetSighting& s) { return s.azimuth_extent_rad; }));
  const int bins = Reach(result.range_extent_m, axes.range_bin_m());
  const int beams = Reach(result.azimuth_extent_rad, axes.beam_spacing_rad());
  for (const Sighted& one : sighted) {
    std::optional<EchoWindow> window = WindowOf(one, axes, bins, beams);
    if (!window) {
      FrameLeftOut& left_out = result.left_out.emplace_back();
      left_out.frame = one.frame;
      left_out.why = "pixels near the target are clipped at the top of the display";
      continue;
    }
    result.windows.push_back(*std::move(window));
    result.sightings.push_back(one.sighting);
    result.poses.push_back(one.pose);
  }
  if (result.windows.empty()) ThrowNoTarget(recording, result.left_out);
  const double cell_bins = sim::GaussianEquivalentWidth(result.range_extent_m) / axes.range_bin_m();
  // A lens gives each beam noise of its own.
  const double cell_beams =
      sonar.beam_forming == BeamForming::kLens
          ? 1.0
          : sim::GaussianEquivalentWidth(result.azimuth_extent_rad) / axes.beam_spacing_rad();
  result.cell_pixels = std::max(1.0, cell_bins) * std::max(1.0, cell_beams);
  return result;
}

void ThrowNoTarget(const RecordingSource& recording, const std::vector<FrameLeftOut>& left_out) {
  std::map<std::string, int> reasons;
  for (const FrameLeftOut& frame : left_out) ++reasons[frame.why];
  const auto most = std::max_element(reasons.begin(), reasons.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  throw DataError("{}: a target that stands alone was found in none of {} frames; {} of them: {}",
                  recording.info().source, left_out.size(), most->second, most->first);
}

}  // namespace sonarcal::calib
