// Finds background by rule in a recording that also holds targets or ground: the cells, and the window of
// range, that one noise law describes.
//
// The measure of a cell is its mean whitened residual (calib/noise/quantile_residual.h) under the plainest
// law (one floor, no gain), times the root of its number of pixels. Its spread is 1 over cells of independent
// pixels, larger if neighbours are correlated, and much larger if there is structure that the law does not
// describe.
#pragma once

#include <vector>

#include "calib/noise/noise_form.h"

namespace sonarcal::calib {

// Returns weights per cell, 0 or 1. Leaves out cells whose measure is more than `reject_beyond` robust
// standard deviations from the median, and fits the law again, until the cells stay the same or for six
// rounds. The first law is fitted to the cells whose mean grey is within the same limit of the sum of the
// medians of its row and column. reject_beyond = 0: keeps all cells.
std::vector<double> KeepBackground(const NoiseForm& form, const NoiseCounts& counts, const NoiseCells& cells,
                                   double reject_beyond, const NoiseFitOptions& options);

struct BackgroundWindow {
  int first_bin = 0;
  int last_bin = 0;
  // Spread of the measure over all cells of the window, including target cells, per degree of freedom.
  double spread = 0.0;
};

// Returns all windows of this share of the bands of `cells` (at least 8 bands) that start at multiples of
// half their length, nearest first. Fits the law of each once, to the cells near the medians. Skips windows
// in which nine pixels of ten have one grey level, because they have no information.
std::vector<BackgroundWindow> BackgroundWindows(const NoiseForm& form, const NoiseCounts& counts,
                                                const NoiseCells& cells, double share,
                                                const NoiseFitOptions& options);

// Returns the longest window, of 1/10, 2/10 or 4/10 of the bands, whose spread is at most 1.25 times the
// smallest spread, or at most 1.25. Of several equally long ones, returns the one with the smallest spread.
// Throws DataError if all windows are skipped.
BackgroundWindow FindBackground(const NoiseForm& form, const NoiseCounts& counts, const NoiseCells& cells,
                                const NoiseFitOptions& options);

}  // namespace sonarcal::calib
