// Table of all figures of a comparison: name, averaging over frames, and which direction is better. Means
// over frames, pooled figures, intervals, floors, metrics.json, per_frame.csv and the comparison with an
// earlier run use this table. To add a figure: compute it in ViewMetrics (metrics/compare.h) and add a row in
// figures.cc. docs/reference/metrics.md gives the formulas.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metrics/compare.h"

namespace sonarcal::metrics {

enum class FigureUnit {
  kNone,       // ratio or count
  kFullScale,  // fraction of full scale; multiply by full_scale for grey levels, by the display's span for dB
  kDecibel,
  kBins,
  kBeams,
  kMetres,
};

// Values of a figure that are better.
enum class Better {
  kLower,
  kHigher,
  kNearOne,
  kNearZero,
  kNeither,  // describes one image
};

// Quantity that is averaged over frames. Non-linear figures are averaged through a linear one.
enum class Averaging {
  kPlain,                // the figure itself
  kRootMeanSquare,       // its square
  kDecibelOfMeanSquare,  // the mean square that the PSNR is computed from
  kReciprocal,           // its reciprocal
};

struct Figure {
  std::string path;   // path in metrics.json, within a view: "iou", "intensity.union.rmse"
  std::string label;  // name for display: "RMSE, union"
  FigureUnit unit = FigureUnit::kNone;
  Better better = Better::kNeither;
  Averaging averaging = Averaging::kPlain;
  bool polar_only = false;  // undefined in a fan, whose pixels are interpolated
  // Quantity to average, of a frame or of pooled frames.
  std::function<std::optional<double>(const ViewMetrics&)> averaged;

  // Conversion from the average to the figure, and back.
  std::optional<double> Finish(double average) const;
  std::optional<double> Unfinish(double figure) const;
  std::optional<double> Of(const ViewMetrics& view) const;
  // Distance from the best value: 0 is best for kLower, kNearOne and kNearZero; for kHigher it decreases as
  // the figure increases. None for kNeither.
  std::optional<double> Badness(double figure) const;
};

const std::vector<Figure>& Figures();

// Throws std::logic_error for an unknown path.
std::size_t FigureIndex(std::string_view path);

// Paths of the figures that publications on sonar simulation report, for a table beside their results.
std::vector<std::string> QuotedFigures();

// Path of the figure that is named "intensity_error", such as "intensity.union.mean_absolute".
std::string IntensityErrorPath(IntensityDomain domain);

}  // namespace sonarcal::metrics
