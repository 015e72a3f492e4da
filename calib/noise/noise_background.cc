#include "calib/noise/noise_background.h"

#include <algorithm>
#include <cmath>

#include "calib/noise/noise_solver.h"
#include "core/math/statistics.h"

namespace sonarcal::calib {
namespace {

constexpr int kRejections = 6;
constexpr int kMeasureIterations = 30;
constexpr int kMinBands = 8;           // per window; fewer show no trend with range
constexpr double kOneLevel = 0.9;      // share of pixels
constexpr double kWindowReject = 2.5;  // robust standard deviations, for the law that measures a window
constexpr double kOneGrey = 1.0;
constexpr double kAsGood = 1.25;

// Measure per cell, under the law that fits the cells of weight 1 best.
std::vector<double> Measure(const NoiseForm& form, const NoiseCounts& counts, const NoiseCells& cells,
                            const std::vector<double>& weight, const NoiseFitOptions& options) {
  NoiseForm plain = form;
  plain.floor_after_gain = false;
  plain.time_varied_gain = TimeVariedGain::kNone;
  plain.speckle = sim::SpeckleLaw::kWeighted;  // much faster, and accurate enough
  NoiseFitOptions quick = options;
  quick.max_iterations = kMeasureIterations;
  const NoiseLaw start = StartOf(plain, counts, cells, 0.0, options.absorption_db_per_m);
  const NoiseSolution solution = SolveNoise(start, plain.fit_span, counts, cells, weight, quick);
  const NoiseAgreement agreement = Agreement(solution.law, counts, cells, {}, options.absorption_db_per_m);
  std::vector<double> measure;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    double pixels = 0.0;
    for (const LevelCount& level : counts[i]) pixels += level.count;
    measure.push_back(pixels > 0.0 ? agreement.whitened_mean.values()[i] * std::sqrt(pixels) : 0.0);
  }
  return measure;
}

// Mean grey per cell without the parts common to rows and columns (median polish). A few cells with targets
// have no effect.
std::vector<double> PolishedGrey(const NoiseCounts& counts, const NoiseCells& cells) {
  constexpr int kSweeps = 6;
  std::vector<double> grey;
  for (const auto& cell : counts) {
    double sum = 0.0;
    double pixels = 0.0;
    for (const auto& [level, count] : cell) {
      sum += static_cast<double>(level) * count;
      pixels += count;
    }
    grey.push_back(sum / std::max(1.0, pixels));
  }
  const auto sweep = [&grey](int lines, int of_line, int line_stride, int stride) {
    for (int line = 0; line < lines; ++line) {
      std::vector<double> values;
      for (int i = 0; i < of_line; ++i) values.push_back(grey[line * line_stride + i * stride]);
      const double median = UpperMedian(std::move(values));
      for (int i = 0; i < of_line; ++i) grey[line * line_stride + i * stride] -= median;
    }
  };
  for (int round = 0; round < kSweeps; ++round) {
    sweep(cells.bands(), cells.beams(), cells.beams(), 1);
    sweep(cells.beams(), cells.bands(), 1, cells.beams());
  }
  return grey;
}

// 1 within `limit` robust standard deviations of the median, else 0. `least`: min value of the limit.
std::vector<double> Within(const std::vector<double>& measure, double limit, double least) {
  const double middle = UpperMedian(measure);
  std::vector<double> distance;
  for (const double value : measure) distance.push_back(std::abs(value - middle));
  const double most = std::max(least, limit * kSigmaPerMad * UpperMedian(distance));
  std::vector<double> weight;
  for (const double value : distance) weight.push_back(value <= most ? 1.0 : 0.0);
  return weight;
}

bool IsOfOneLevel(const NoiseCounts& counts, int full_scale) {
  std::vector<double> histogram(full_scale + 1);
  double all = 0.0;
  for (const auto& cell : counts) {
    for (const auto& [level, count] : cell) {
      histogram[level] += count;
      all += count;
    }
  }
  return *std::max_element(histogram.begin(), histogram.end()) >= kOneLevel * all;
}

}  // namespace

std::vector<double> KeepBackground(const NoiseForm& form, const NoiseCounts& counts, const NoiseCells& cells,
                                   double reject_beyond, const NoiseFitOptions& options) {
  if (!(reject_beyond > 0.0)) return std::vector<double>(cells.count(), 1.0);
  std::vector<double> weight = Within(PolishedGrey(counts, cells), reject_beyond, kOneGrey);
  for (int round = 0; round < kRejections; ++round) {
    std::vector<double> next = Within(Measure(form, counts, cells, weight, options), reject_beyond, 0.0);
    if (next == weight) break;
    weight = std::move(next);
  }
  return weight;
}

std::vector<BackgroundWindow> BackgroundWindows(const NoiseForm& form, const NoiseCounts& counts,
                                                const NoiseCells& cells, double share,
                                                const NoiseFitOptions& options) {
  const int length = std::clamp(static_cast<int>(std::lround(share * cells.bands())),
                                std::min(kMinBands, cells.bands()), cells.bands());
  std::vector<BackgroundWindow> windows;
  for (int band = 0; band + length <= cells.bands(); band += std::max(1, length / 2)) {
    NoiseCells window = cells;
    window.first_bin = cells.first_bin + band * cells.band_bins;
    window.last_bin = cells.EndOfBand(band + length - 1);
    const auto first = counts.begin() + band * cells.beams();
    const NoiseCounts within(first, first + length * cells.beams());
    if (IsOfOneLevel(within, cells.full_scale)) continue;
    const std::vector<double> weight = Within(PolishedGrey(within, window), kWindowReject, kOneGrey);
    double square = 0.0;
    for (const double value : Measure(form, within, window, weight, options)) square += value * value;
    const int free = cells.beams() + 2;  // levels of the beams, trend, and looks or span
    windows.push_back(
        {window.first_bin, window.last_bin, std::sqrt(square / std::max(1, window.count() - free))});
  }
  return windows;
}

BackgroundWindow FindBackground(const NoiseForm& form, const NoiseCounts& counts, const NoiseCells& cells,
                                const NoiseFitOptions& options) {
  std::vector<BackgroundWindow> windows;
  for (const double share : {0.1, 0.2, 0.4}) {
    const auto more = BackgroundWindows(form, counts, cells, share, options);
    windows.insert(windows.end(), more.begin(), more.end());
  }
  if (windows.empty()) {
    throw DataError("no window of range holds noise: nine pixels of ten are of one grey level in each");
  }
  const auto by_spread = [](const BackgroundWindow& a, const BackgroundWindow& b) {
    return a.spread < b.spread;
  };
  const double least = std::min_element(windows.begin(), windows.end(), by_spread)->spread;
  const double most = kAsGood * std::max(1.0, least);
  std::erase_if(windows, [most](const BackgroundWindow& window) { return window.spread > most; });
  return *std::min_element(windows.begin(), windows.end(),
                           [&](const BackgroundWindow& a, const BackgroundWindow& b) {
                             const int longer = (a.last_bin - a.first_bin) - (b.last_bin - b.first_bin);
                             return longer != 0 ? longer > 0 : by_spread(a, b);
                           });
}

}  // namespace sonarcal::calib
