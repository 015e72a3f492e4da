// What a comparison says beyond its means, as parts of a report: in words first, then as curves and maps.
#pragma once

#include <string>
#include <vector>

#include "apps/report/html/html_report.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal::report {

// The comparison in a few sentences, for who reads nothing else.
std::vector<std::string> SummaryInWords(const metrics::MetricsReport& metrics);

// The ratios as curves over the segmentation's threshold, and the areas under them. Nothing where none were
// measured.
void AddThresholdSweep(HtmlReport& report, const metrics::MetricsReport& metrics);

// Grey values of both images as histograms, and the quantiles of one over those of the other.
void AddGreyLevels(HtmlReport& report, const metrics::MetricsReport& metrics);

// Every figure of the polar images with its interval and floor.
void AddEveryFigure(HtmlReport& report, const metrics::MetricsReport& metrics);

}  // namespace sonarcal::report
