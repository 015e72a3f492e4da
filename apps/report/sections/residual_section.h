// Residuals of a simulation (metrics/measures/residuals.h) as part of a report: over range, over beams, as a
// map, and for a known scene over incidence and by material.
#pragma once

#include "apps/report/html/html_report.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal::report {

// Must be within a section. Adds nothing without residuals.
void AddResiduals(HtmlReport& report, const metrics::MetricsReport& metrics);

// Part of a table's numeric axis with the largest mean |difference|, out of `bands` equal parts. Differences
// are fractions of full scale, over the pixels of all frames.
struct WorstBand {
  double from = 0.0;
  double to = 0.0;
  double mean_absolute = 0.0;
  double bias = 0.0;  // above 0: the simulation is brighter
};

// Finds the worst band over either object region. Nullopt if no band has pixels.
std::optional<WorstBand> FindWorstBand(const metrics::ResidualTable& table, int bands);

}  // namespace sonarcal::report
