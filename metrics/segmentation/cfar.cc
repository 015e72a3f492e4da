#include "metrics/segmentation/cfar.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "core/math/local_sums.h"
#include "metrics/segmentation/false_alarm.h"

namespace sonarcal::metrics {
namespace {

// Min spread of grey levels, as a fraction of full scale.
constexpr double kMinSpread = 1e-3;
// Lower quantile of the ordered statistic in grey; with os_quantile it determines the background's spread.
constexpr double kLowerPart = 1.0 / 3.0;

int CellPixels(const SegmentationOptions& options) {
  return options.cell_rows * options.cell_cols;
}

// Calls `decades(window, count, row, col)` for each pixel that has training cells, row by row.
template <typename Decades>
Grid<float> EveryPixel(const LocalSums& sums, int rows, int cols, const SegmentationOptions& options,
                       Decades decades) {
  const TrainingShape shape = {options.guard_rows, options.guard_cols, options.training_rows,
                               options.training_cols};
  Grid<float> result(rows, cols);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const TrainingWindow window = WindowAt(shape, row, col, rows, cols);
      if (window.count() <= 0) {
        throw DataError(
            "segmentation by {}: no training cell about pixel (row {}, column {}) of {} x {}, expected an "
            "image larger than the guard of {} rows and {} columns to each side",
            ToString(options.method), row, col, rows, cols, options.guard_rows, options.guard_cols);
      }
      const int count = sums.Count(window);
      if (count > 0) result(row, col) = static_cast<float>(decades(window, count, row, col));
    }
  }
  return result;
}

int RankOf(double quantile, int count) {
  return std::clamp(static_cast<int>(std::lround(quantile * count)), 1, count);
}

// One distribution per number of training cells, created on first use. Distributions with a closed form cost
// nothing. Others are tabulated for numbers 3 % apart, which changes a probability by less than 0.01 decades.
template <typename Law>
class LawsByCount {
 public:
  LawsByCount(bool closed_form, std::function<Law(int count)> make)
      : closed_form_(closed_form), make_(std::move(make)) {}

  const Law& Of(int count) {
    const int like = closed_form_ ? count : Alike(count);
    auto law = laws_.find(like);
    if (law == laws_.end()) law = laws_.emplace(like, make_(like)).first;
    return law->second;
  }

 private:
  static int Alike(int count) {
    const double step = std::log(1.03);
    return std::max(1, static_cast<int>(std::lround(std::exp(step * std::round(std::log(count) / step)))));
  }

  bool closed_form_;
  std::function<Law(int count)> make_;
  std::map<int, Law> laws_;
};

Grid<float> CaInPower(const Grid<float>& power, const SegmentationOptions& options, const Mask* valid) {
  const Grid<float> cell = BoxMean(power, options.cell_rows, options.cell_cols, valid);
  const LocalSums sums(power, valid);
  const double cell_looks = options.looks * CellPixels(options);
  const bool closed_form = cell_looks == 1.0;
  LawsByCount<DecadesTable> laws(closed_form, [&](int count) {
    return DecadesTable(
        [&, count](double ratio) { return CellAveragingDecades(cell_looks, options.looks * count, ratio); });
  });
  return EveryPixel(sums, power.rows(), power.cols(), options,
                    [&](const TrainingWindow& window, int count, int row, int col) -> double {
                      const double mean = sums.Over(window).mean;
                      if (!(mean > 0.0)) return cell(row, col) > 0.0F ? kMaxDecades : 0.0;
                      const double ratio = cell(row, col) / mean;
                      return closed_form ? CellAveragingDecades(1.0, options.looks * count, ratio)
                                         : laws.Of(count)(ratio);
                    });
}

// Values ordered by level, because in power a few echoes would use up the classes of LocalOrder.
Grid<float> LevelsOf(const Grid<float>& power) {
  static constexpr float kSilence = 1e-30F;
  Grid<float> level(power.rows(), power.cols());
  std::transform(power.values().begin(), power.values().end(), level.values().begin(),
                 [](float p) { return std::log(std::max(p, kSilence)); });
  return level;
}

Grid<float> OsInPower(const Grid<float>& power, const SegmentationOptions& options, const Mask* valid) {
  const Grid<float> cell = LevelsOf(BoxMean(power, options.cell_rows, options.cell_cols, valid));
  const LocalSums sums(power, valid);  // for the number of training cells
  LocalOrder order(LevelsOf(power), valid);
  const double cell_looks = options.looks * CellPixels(options);
  LawsByCount<OrderedStatisticLaw> laws(cell_looks == 1.0 && options.looks == 1.0, [&](int count) {
    return OrderedStatisticLaw(cell_looks, options.looks, count, RankOf(options.os_quantile, count));
  });
  return EveryPixel(sums, power.rows(), power.cols(), options,
                    [&](const TrainingWindow& window, int count, int row, int col) -> double {
                      order.MoveTo(window);
                      const int rank = RankOf(options.os_quantile, count);
                      return laws.Of(count).Decades(std::exp(cell(row, col) - order.RankthSmallest(rank)));
                    });
}

}  // namespace

Grid<float> CfarDecadesInPower(const Grid<float>& power, const SegmentationOptions& options,
                               const Mask* valid) {
  return options.method == SegmentationMethod::kCaCfar ? CaInPower(power, options, valid)
                                                       : OsInPower(power, options, valid);
}

Grid<float> CfarDecadesInGrey(const Grid<float>& grey, double full_scale, const SegmentationOptions& options,
                              const Mask* valid) {
  // The mean of grey levels of a logarithmic display is distributed almost like the logarithm of a mean of as
  // many looks.
  const Grid<float> cell = BoxMean(grey, options.cell_rows, options.cell_cols, valid);
  const double looks = options.looks * CellPixels(options);
  const double min_spread = kMinSpread * full_scale;
  const LocalSums sums(cell, valid);
  if (options.method == SegmentationMethod::kCaCfar) {
    const LogMeanLaw law(looks);
    return EveryPixel(
        sums, cell.rows(), cell.cols(), options,
        [&](const TrainingWindow& window, int, int row, int col) -> double {
          const Moments moments = sums.Over(window);
          return law.Decades((cell(row, col) - moments.mean) / std::max(moments.spread, min_spread));
        });
  }
  LocalOrder order(cell, valid);
  const double lower = kLowerPart * options.os_quantile;
  const LogQuantileLaw law(looks, lower, options.os_quantile);
  return EveryPixel(sums, cell.rows(), cell.cols(), options,
                    [&](const TrainingWindow& window, int count, int row, int col) -> double {
                      order.MoveTo(window);
                      const double high = order.RankthSmallest(RankOf(options.os_quantile, count));
                      const double low = order.RankthSmallest(RankOf(lower, count));
                      return law.Decades((cell(row, col) - high) / std::max(high - low, min_spread));
                    });
}

}  // namespace sonarcal::metrics
