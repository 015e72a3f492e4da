// Distance between the outlines of two regions, in metres.
//
// The outline of a region consists of its pixels that have one of their four neighbours outside it, or lie at
// the image's border. Regions are those of the polar image. Their pixels' centres are points of the plane, x
// = r sin(azimuth), y = r cos(azimuth), with Euclidean distances; nothing is scan-converted.
//
//   distance of a point   to the nearest point of the other outline
//   mean                  over the points of both outlines (average symmetric surface distance)
//   Hausdorff 95          the larger of two 95th percentiles, one of each outline's points: the
//                         ceil(0.95 n)-th smallest of n
//
// If either region is empty there is no value: never 0 or infinity.
#pragma once

#include <cstdint>
#include <optional>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::metrics {

// Distance of one frame, or of several pooled. Then the mean is over all points, and there is no percentile,
// because sums do not determine it.
struct OutlineDistance {
  int frames = 0;           // frames in which both regions have pixels
  std::int64_t points = 0;  // points of both outlines
  double sum_m = 0.0;       // sum of the points' distances
  double percentile_m = 0.0;

  std::optional<double> mean_m() const;
  std::optional<double> hausdorff_95_m() const;  // only if frames is 1

  OutlineDistance& operator+=(const OutlineDistance& other);
  bool operator==(const OutlineDistance&) const = default;
};

// Masks of range_bins x beam_count.
OutlineDistance MeasureOutlines(const Mask& real, const Mask& simulated, const PolarAxes& axes);

}  // namespace sonarcal::metrics
