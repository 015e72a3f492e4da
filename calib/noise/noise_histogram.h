// Counts of grey values of target-free pings per cell (a few range bins x one beam), for the fit and the
// evaluation of a noise law. Each ping is counted separately, because pings drift: pings are independent,
// pixels are not.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::calib {

struct LevelCount {
  int level = 0;
  int count = 0;
};

struct NoiseCells {
  PolarAxes axes;
  int first_bin = 0;  // of band 0
  int last_bin = 0;   // one past the last bin of the last band
  int band_bins = 1;
  int full_scale = 255;            // levels run from 0 to this
  std::optional<Mask> valid = {};  // counted samples of an image; absent: all

  int bands() const { return (last_bin - first_bin + band_bins - 1) / band_bins; }
  int beams() const { return axes.beam_count(); }
  int count() const { return bands() * beams(); }
  int EndOfBand(int band) const;
  double RangeM(int band) const;  // centre of the band
};

// Counts of one ping or of several. cell = band * beams + beam; levels rise within a cell.
using NoiseCounts = std::vector<std::vector<LevelCount>>;

// Rounds values to whole levels. Leaves out the bins of streaks along azimuth (core/imaging/saturation.h).
// Throws DataError if the image is not grey with `cells.full_scale` or has other axes.
NoiseCounts CountGrey(const PolarImage& image, const NoiseCells& cells);

NoiseCounts AddCounts(std::span<const NoiseCounts> pings, const NoiseCells& cells);

}  // namespace sonarcal::calib
