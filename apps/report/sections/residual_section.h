// Where a simulation is wrong (metrics/measures/residuals.h), as part of a report: over range, over beams, as
// a map, and over incidence and by material where the scene is known.
#pragma once

#include "apps/report/html/html_report.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal::report {

// Within a section. Nothing where no residuals were collected.
void AddResiduals(HtmlReport& report, const metrics::MetricsReport& metrics);

// The part of a table's numeric axis over which the mean |difference| is largest, in `bands` even parts.
// Differences are fractions of full scale, over the pixels of all frames.
struct WorstBand {
  double from = 0.0;
  double to = 0.0;
  double mean_absolute = 0.0;
  double bias = 0.0;  // above 0: the simulation is brighter
};

// Over either object region. None where no band has pixels.
std::optional<WorstBand> FindWorstBand(const metrics::ResidualTable& table, int bands);

}  // namespace sonarcal::report
