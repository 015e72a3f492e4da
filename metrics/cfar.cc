#include "metrics/cfar.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "metrics/false_alarm.h"
#include "metrics/local_sums.h"

namespace sonarcal {
namespace {

// Of grey levels, in parts of full scale.
constexpr double kLeastSpread = 1e-3;
// Of the ordered statistic in grey: with os_quantile it tells the background's spread.
constexpr double kLowerPart = 1.0 / 3.0;

int CellPixels(const SegmentationOptions& options) {
  return options.cell_rows * options.cell_cols;
}

// Calls `decades(window, row, col)` for each pixel, row by row.
template <typename Decades>
Grid<float> EveryPixel(int rows, int cols, const SegmentationOptions& options, Decades decades) {
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
      result(row, col) = static_cast<float>(decades(window, row, col));
    }
  }
  return result;
}

int RankOf(double quantile, int count) {
  return std::clamp(static_cast<int>(std::lround(quantile * count)), 1, count);
}

// A law for each number of training cells, made when first asked for. With a closed form it costs nothing;
// without, laws are tabulated for numbers 3 % apart, which moves a chance by less than 0.01 decades.
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

Grid<float> CaInPower(const Grid<float>& power, const SegmentationOptions& options) {
  const Grid<float> cell = BoxMean(power, options.cell_rows, options.cell_cols);
  const LocalSums sums(power);
  const double cell_looks = options.looks * CellPixels(options);
  const bool closed_form = cell_looks == 1.0;
  LawsByCount<DecadesTable> laws(closed_form, [&](int count) {
    return DecadesTable(
        [&, count](double ratio) { return CellAveragingDecades(cell_looks, options.looks * count, ratio); });
  });
  return EveryPixel(power.rows(), power.cols(), options,
                    [&](const TrainingWindow& window, int row, int col) -> double {
                      const double mean = sums.Over(window).mean;
                      if (!(mean > 0.0)) return cell(row, col) > 0.0F ? kMostDecades : 0.0;
                      const double ratio = cell(row, col) / mean;
                      return closed_form ? CellAveragingDecades(1.0, window.count(), ratio)
                                         : laws.Of(window.count())(ratio);
                    });
}

// Ordered by level: a few echoes must not use up the classes that LocalOrder has.
Grid<float> LevelsOf(const Grid<float>& power) {
  static constexpr float kSilence = 1e-30F;
  Grid<float> level(power.rows(), power.cols());
  std::transform(power.values().begin(), power.values().end(), level.values().begin(),
                 [](float p) { return std::log(std::max(p, kSilence)); });
  return level;
}

Grid<float> OsInPower(const Grid<float>& power, const SegmentationOptions& options) {
  const Grid<float> cell = LevelsOf(BoxMean(power, options.cell_rows, options.cell_cols));
  LocalOrder order(LevelsOf(power));
  const double cell_looks = options.looks * CellPixels(options);
  LawsByCount<OrderedStatisticLaw> laws(cell_looks == 1.0 && options.looks == 1.0, [&](int count) {
    return OrderedStatisticLaw(cell_looks, options.looks, count, RankOf(options.os_quantile, count));
  });
  return EveryPixel(
      power.rows(), power.cols(), options, [&](const TrainingWindow& window, int row, int col) -> double {
        order.MoveTo(window);
        const int rank = RankOf(options.os_quantile, window.count());
        return laws.Of(window.count()).Decades(std::exp(cell(row, col) - order.RankthSmallest(rank)));
      });
}

}  // namespace

Grid<float> CfarDecadesInPower(const Grid<float>& power, const SegmentationOptions& options) {
  return options.method == SegmentationMethod::kCaCfar ? CaInPower(power, options)
                                                       : OsInPower(power, options);
}

Grid<float> CfarDecadesInGrey(const Grid<float>& grey, double full_scale,
                              const SegmentationOptions& options) {
  // Means of grey levels of a logarithmic display lie about as the logarithm of a mean of as many looks.
  const Grid<float> cell = BoxMean(grey, options.cell_rows, options.cell_cols);
  const double looks = options.looks * CellPixels(options);
  const double least_spread = kLeastSpread * full_scale;
  if (options.method == SegmentationMethod::kCaCfar) {
    const LocalSums sums(cell);
    const LogMeanLaw law(looks);
    return EveryPixel(
        cell.rows(), cell.cols(), options, [&](const TrainingWindow& window, int row, int col) -> double {
          const Moments moments = sums.Over(window);
          return law.Decades((cell(row, col) - moments.mean) / std::max(moments.spread, least_spread));
        });
  }
  LocalOrder order(cell);
  const double lower = kLowerPart * options.os_quantile;
  const LogQuantileLaw law(looks, lower, options.os_quantile);
  return EveryPixel(cell.rows(), cell.cols(), options,
                    [&](const TrainingWindow& window, int row, int col) -> double {
                      order.MoveTo(window);
                      const double high = order.RankthSmallest(RankOf(options.os_quantile, window.count()));
                      const double low = order.RankthSmallest(RankOf(lower, window.count()));
                      return law.Decades((cell(row, col) - high) / std::max(high - low, least_spread));
                    });
}

}  // namespace sonarcal
