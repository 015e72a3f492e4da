// A comparison of recordings (metrics/json/metrics_json.h) as parts of a report, for every command that
// compares.
#pragma once

#include <string>
#include <vector>

#include "apps/report/html/html_report.h"
#include "apps/report/pictures/comparison_pictures.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal::report {

// What is synthetic of it, in a box of its own; said too where the real side was recorded by a sonar.
void AddSyntheticCallout(HtmlReport& report, bool real_is_synthetic, const std::string& real_name);

// The few numbers to look at first.
void AddKeyFigures(HtmlReport& report, const metrics::MetricsReport& metrics);

// Means over frames and pooled figures with their intervals, the noise floor beside them, and a table of
// frames. Within a section.
void AddMetricTables(HtmlReport& report, const metrics::MetricsReport& metrics);

// The same figures before and after something was done, side by side: means over the same frames.
void AddBeforeAfterTable(HtmlReport& report, const metrics::MetricsReport& before,
                         const metrics::MetricsReport& after, const std::string& caption);

// Explains the colours of overlays and regions, once per page. `real`: name of the real side.
void AddPictureLegend(HtmlReport& report, const std::string& real);

// Recorded (or synthetic), simulated, overlay and regions of one frame, polar and fan.
void AddFramePictures(HtmlReport& report, const FramePictures& of_frame, const std::string& caption,
                      bool real_is_synthetic);

// What the numbers mean, how the object is found and what no simulator can beat, in words. Adds a section.
void AddMetricDefinitions(HtmlReport& report, const metrics::MetricsReport& metrics);

}  // namespace sonarcal::report
