// Details of a comparison as parts of a report: first sentences, then curves and maps.
#pragma once

#include <string>
#include <vector>

#include "apps/report/html/html_report.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal::report {

// Summarises the comparison in a few sentences.
std::vector<std::string> SummaryInWords(const metrics::MetricsReport& metrics);

// Adds the ratios as curves over the threshold of the segmentation, with the areas under them. Adds nothing
// if they were not measured.
void AddThresholdSweep(HtmlReport& report, const metrics::MetricsReport& metrics);

// Adds histograms of the grey values of both images, and the quantiles of one over those of the other.
void AddGreyLevels(HtmlReport& report, const metrics::MetricsReport& metrics);

// Adds every figure of the polar images with its interval and floor.
void AddEveryFigure(HtmlReport& report, const metrics::MetricsReport& metrics);

}  // namespace sonarcal::report
