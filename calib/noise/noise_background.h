// Background by rule, where a recording holds targets or ground as well: which cells, and which window of
// range, one noise law describes.
//
// Measure: of each cell the whitened residual (calib/noise/quantile_residual.h) under the plainest law - one
// floor, no gain - averaged and times the root of its pixels: spread 1 over cells of independent pixels, more
// where neighbours are alike, much more where there is structure that the law does not know.
#pragma once

#include <vector>

#include "calib/noise/noise_form.h"

namespace sonarcal::calib {

// Weights by cell, 0 or 1: cells whose measure lies further than `reject_beyond` robust standard deviations
// from the median of all are left out, and the law fitted again, until the same cells stay or for six rounds.
// The first law is fitted to the cells whose mean grey lies so near the sum of a row's and a column's median.
// reject_beyond = 0: all stay.
std::vector<double> KeepBackground(const NoiseForm& form, const NoiseCounts& counts, const NoiseCells& cells,
                                   double reject_beyond, const NoiseFitOptions& options);

struct BackgroundWindow {
  int first_bin = 0;
  int last_bin = 0;
  double spread =
      0.0;  // of the measure over the window's cells, its target cells included, per degree of freedom
};

// All windows of this share of the bands of `cells` (but 8 bands at least) that start at multiples of half
// their length, nearest first. The law of each is fitted once, to the cells near the medians. Passed over are
// windows of which nine pixels of ten are of one grey level, as they say nothing.
std::vector<BackgroundWindow> BackgroundWindows(const NoiseForm& form, const NoiseCounts& counts,
                                                const NoiseCells& cells, double share,
                                                const NoiseFitOptions& options);

// The longest window, of a tenth, two or four tenths of the bands, whose spread is no more than
// 1.25 times the least of all windows, or 1.25; of several as long the one of least spread. Throws DataError
// where all are passed over.
BackgroundWindow FindBackground(const NoiseForm& form, const NoiseCounts& counts, const NoiseCells& cells,
                                const NoiseFitOptions& options);

}  // namespace sonarcal::calib
