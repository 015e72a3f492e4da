// Scan conversion from a polar image I(range, azimuth) to a fan image I(x, y): x = R sin(theta) to the right
// and y = R cos(theta) forward, in metres (Park 2024, Eq. 4). Used for display and for measures in metres. No
// fit uses a fan image, because interpolation correlates its pixels.
//
// The fan is the sector range_min .. range_max between the outer edges of the outer beams. It includes half a
// beam beyond the outer centres; its near border is the arc at range_min. A pixel belongs to the fan if its
// centre does. Positive azimuth is on the right; the picture is never mirrored.
//
//   FanMap map(image.axes);                    // the geometry, computed once ...
//   FanImage fan = map.Apply(image);           // ... serves any number of frames
//   Mask object = map.ApplyNearest(polar_mask);
#pragma once

#include <cstdint>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal {

struct FanOptions {
  double pixel_m = 0.0;             // side of a pixel; 0: from height_px
  int height_px = 0;                // height of the fan; 0: one pixel per range bin
  int default_max_height_px = 800;  // upper limit of the default height only

  // Throws DataError that names the field, its value and the limit.
  void Check() const;
};

// Smallest grid of square pixels that holds the whole fan. Throws DataError if the axes or the options are
// not valid, or if the picture would have more than 100 million pixels.
FanAxes FanAxesFor(const PolarAxes& polar, const FanOptions& options = {});

// Position of each pixel of a fan in a polar image.
class FanMap {
 public:
  FanMap(const PolarAxes& polar, const FanAxes& fan);
  explicit FanMap(const PolarAxes& polar, const FanOptions& options = {})
      : FanMap(polar, FanAxesFor(polar, options)) {}

  const FanAxes& axes() const { return axes_; }
  const PolarAxes& polar_axes() const { return polar_axes_; }
  const Mask& inside() const { return inside_; }

  // Bilinear interpolation between bin centres and between (unevenly spaced) beam centres. Beyond the
  // outermost centres the outermost value is used. An image linear in range is therefore reproduced exactly
  // between the centres of the first and the last bin. The image must have this map's shape.
  Grid<float> Apply(const Grid<float>& polar) const;
  FanImage Apply(const PolarImage& polar) const;

  // Value of the bin and beam that contain the pixel's centre: for masks, and for images whose values must
  // not be mixed (depth with missing pixels). Pixels outside the fan get `outside`.
  template <typename T>
  Grid<T> ApplyNearest(const Grid<T>& polar, T outside = T{}) const;

 private:
  // Interpolation between the polar pixels (bin, beam), (bin + 1, beam), (bin, beam + 1), (bin + 1, beam +
  // 1).
  struct Sample {
    std::int32_t fan_index;
    std::int32_t polar_index;  // index of (bin, beam)
    float bin_weight;          // weight of bin + 1, 0..1
    float beam_weight;         // weight of beam + 1, 0..1
  };

  void CheckShape(int rows, int cols) const;
  // Index offset from a bin to the next; 0 if the image has a single bin.
  int bin_step() const { return polar_axes_.range_bins > 1 ? polar_axes_.beam_count() : 0; }

  PolarAxes polar_axes_;
  FanAxes axes_;
  Mask inside_;
  std::vector<Sample> samples_;  // pixels inside the fan only, row by row
};

template <typename T>
Grid<T> FanMap::ApplyNearest(const Grid<T>& polar, T outside) const {
  CheckShape(polar.rows(), polar.cols());
  Grid<T> fan(axes_.rows, axes_.cols, outside);
  for (const Sample& sample : samples_) {
    // Edges lie midway between centres, so the nearer centre is that of the pixel's own bin and beam.
    const int bin_offset = sample.bin_weight >= 0.5f ? bin_step() : 0;
    const int beam_offset = sample.beam_weight >= 0.5f ? 1 : 0;
    fan.values()[sample.fan_index] = polar.values()[sample.polar_index + bin_offset + beam_offset];
  }
  return fan;
}

}  // namespace sonarcal
