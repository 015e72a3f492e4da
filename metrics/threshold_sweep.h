// Occupancy as a curve over the setting that a segmentation's threshold follows from
// (metrics/segmentation/scored_image.h), so that no one threshold has to be trusted. Both images take the
// same setting; all else stays as it is.
//
//   micro  the ratio of the frames' pooled counts
//   macro  the mean of the frames' ratios; frames in which it is undefined are left out
//
// The area under a curve is its mean height: the integral by trapezoids over those intervals at both of whose
// ends it is defined, over their length, which is told as a share of the axis. Memory does not grow with the
// number of frames.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "metrics/measures/occupancy.h"
#include "metrics/segmentation/segmentation_options.h"

namespace sonarcal::metrics {

struct SweepOptions {
  int steps = 0;  // settings that are tried, 2..1000; 0: no sweep
  // Lowest and highest setting; absent: DefaultSweepRange of the method.
  std::optional<double> low = {};
  std::optional<double> high = {};

  // Throws DataError naming field, value and limit.
  void Check(SegmentationMethod method) const;
};

struct SweepRange {
  double low = 0.0;
  double high = 1.0;
};

// background_sigma 0.5..10 standard deviations; local_contrast 0..0.5 and other grey levels 0..1 of full
// scale; rates of false alarms from 10^-0.5 to 10^-8.
SweepRange DefaultSweepRange(SegmentationMethod method);

// `steps` settings, evenly from lowest to highest; none where steps is 0.
std::vector<double> SweepSettings(const SweepOptions& options, SegmentationMethod method);

inline constexpr int kSweepRatios = 5;

struct SweepRatio {
  const char* name;  // as in metrics.json
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

  // A frame's counts at every setting.
  void Add(const std::vector<Occupancy>& by_setting);

  // Pooled counts at a setting.
  const Occupancy& Pooled(std::size_t setting) const { return points_[setting].pooled; }

  // Height of the curve of kSweptRatios[ratio] at every setting, where it is defined.
  std::vector<std::optional<double>> MicroCurve(int ratio) const;
  std::vector<std::optional<double>> MacroCurve(int ratio) const;

  // Nothing where no interval has both ends defined.
  std::optional<SweepArea> AreaUnder(const std::vector<std::optional<double>>& curve) const;

  // A line a setting: setting, ns, nr, na, then micro and macro of each ratio; empty where undefined.
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
