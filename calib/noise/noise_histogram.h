// Grey values of target-free pings, counted by cell: a few range bins x one beam. What the noise law is
// fitted to, and judged on. A ping is counted apart from the others, because pings drift: they, not pixels,
// are what is independent.
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
  std::optional<Mask> valid = {};  // samples of an image that are counted; absent: all

  int bands() const { return (last_bin - first_bin + band_bins - 1) / band_bins; }
  int beams() const { return axes.beam_count(); }
  int count() const { return bands() * beams(); }
  int EndOfBand(int band) const;
  double RangeM(int band) const;  // centre
};

// Counts of one ping, or of several: cell = band * beams + beam; levels rise within a cell.
using NoiseCounts = std::vector<std::vector<LevelCount>>;

// Values are rounded to whole levels. Throws DataError where the image is not grey of `cells.full_scale`, or
// of other axes.
NoiseCounts CountGrey(const PolarImage& image, const NoiseCells& cells);

NoiseCounts AddCounts(std::span<const NoiseCounts> pings, const NoiseCells& cells);

}  // namespace sonarcal::calib
