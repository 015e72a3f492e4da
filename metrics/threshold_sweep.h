// Occupancy as a function of the segmentation's setting (metrics/segmentation/scored_image.h), so that
// results do not depend on one threshold. Both images use the same setting; all other options stay constant.
//
//   micro  ratio of the frames' pooled counts
//   macro  mean of the frames' ratios, without frames in which the ratio is undefined
//
// The area under a curve is its mean height: the trapezoidal integral over the intervals with both ends
// defined, divided by their length. This length is reported as a fraction of the axis. Memory does not grow
// with the number of frames.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "metrics/measures/occupancy.h"
#include "metrics/segmentation/segmentation_options.h"

namespace sonarcal::metrics {

struct SweepOptions {
  int steps = 0;  // number of settings, 2..1000; 0: no sweep
  // Lowest and highest setting; absent: DefaultSweepRange of the method.
  std::optional<double> low = {};
  std::optional<double> high = {};

  // Throws DataError that names the field, its value and the limit.
  void Check(SegmentationMethod method) const;
};

struct SweepRange {
  double low = 0.0;
  double high = 1.0;
};

// background_sigma 0.5..10 standard deviations; local_contrast 0..0.5 and other grey levels 0..1 of full
// scale; false-alarm rates from 10^-0.5 to 10^-8.
SweepRange DefaultSweepRange(SegmentationMethod method);

// `steps` evenly spaced settings, lowest first; none if steps is 0.
std::vector<double> SweepSettings(const SweepOptions& options, SegmentationMethod method);

inline constexpr int kSweepRatios = 5;

struct SweepRatio {
  const char* name;  // name in metrics.json
  std::optional<double> (Occupancy::*of)() const;
};

// ns_over_nr, na_over_ns, na_over_nr, iou, dice.
extern const std::array<SweepRatio, kSweepRatios> kSweptRatios;

struct SweepArea {
  double area = 0.0;
  double axis_share = 0.0;
};

class ThresholdSweep {
 public:
  explicit ThresholdSweep(std::vector<double> settings);

  const std::vector<double>& settings() const { return settings_; }
  int frames() const { return frames_; }

  // Adds a frame's counts at every setting.
  void Add(const std::vector<Occupancy>& by_setting);

  // Pooled counts at a setting.
  const Occupancy& Pooled(std::size_t setting) const { return points_[setting].pooled; }

  // Height of the curve of kSweptRatios[ratio] at every setting; nothing where it is undefined.
  std::vector<std::optional<double>> MicroCurve(int ratio) const;
  std::vector<std::optional<double>> MacroCurve(int ratio) const;

  // Returns nothing if no interval has both ends defined.
  std::optional<SweepArea> AreaUnder(const std::vector<std::optional<double>>& curve) const;

  // One line per setting: setting, ns, nr, na, then micro and macro of each ratio; empty if undefined.
  std::string Csv() const;

 private:
  struct Point {
    Occupancy pooled;
    std::array<double, kSweepRatios> sum{};
    std::array<int, kSweepRatios> defined{};
  };

  std::vector<double> settings_;
  std::vector<Point> points_;
  int frames_ = 0;
};

}  // namespace sonarcal::metrics
