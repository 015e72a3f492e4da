// Every figure of a comparison, once: its name, how frames are averaged, and which way is better. Means over
// frames, pooled figures, intervals, floors, metrics.json, per_frame.csv and the comparison with an earlier
// run all walk this table. To add a figure: measure it into ViewMetrics (metrics/compare.h) and add a row in
// figures.cc; docs/reference/metrics.md has the formulas.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metrics/compare.h"

namespace sonarcal::metrics {

enum class FigureUnit {
  kNone,       // a ratio or a count
  kFullScale,  // fraction of full scale: times full_scale grey levels, times the display's span dB
  kDecibel,
  kBins,
  kBeams,
  kMetres,
};

// Which way a figure is better.
enum class Better {
  kLower,
  kHigher,
  kNearOne,
  kNearZero,
  kNeither,  // describes one image
};

// What is averaged over frames, as a root is no linear thing.
enum class Averaging {
  kPlain,                // the figure itself
  kRootMeanSquare,       // its square
  kDecibelOfMeanSquare,  // the mean square whose PSNR it is
  kReciprocal,           // its reciprocal
};

struct Figure {
  std::string path;   // in metrics.json, within a view: "iou", "intensity.union.rmse"
  std::string label;  // for people: "RMSE, union"
  FigureUnit unit = FigureUnit::kNone;
  Better better = Better::kNeither;
  Averaging averaging = Averaging::kPlain;
  bool polar_only = false;  // has no meaning in a fan, whose pixels are interpolated
  // What is averaged, of a frame or of pooled frames.
  std::function<std::optional<double>(const ViewMetrics&)> averaged;

  // From what is averaged to the figure, and back.
  std::optional<double> Finish(double average) const;
  std::optional<double> Unfinish(double figure) const;
  std::optional<double> Of(const ViewMetrics& view) const;
  // How far from the best: 0 is best for kLower, kNearOne and kNearZero; for kHigher it falls as the figure
  // rises. None for kNeither.
  std::optional<double> Badness(double figure) const;
};

const std::vector<Figure>& Figures();

// Throws std::logic_error for a path that is not in the table.
std::size_t FigureIndex(std::string_view path);

// "intensity.union.mean_absolute" and its like: the figure named "intensity_error".
std::string IntensityErrorPath(IntensityDomain domain);

}  // namespace sonarcal::metrics
