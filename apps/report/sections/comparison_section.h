// A comparison of recordings (metrics/json/metrics_json.h) as parts of a report, for every command that
// compares.
#pragma once

#include <string>
#include <vector>

#include "apps/report/html/html_report.h"
#include "apps/workflow/compare.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal::report {

// Adds a box that states which side is synthetic, also if a sonar recorded the real side.
void AddSyntheticCallout(HtmlReport& report, bool real_is_synthetic, const std::string& real_name);

// Adds a box to the page of one recording, if it is synthetic.
void AddSyntheticRecordingCallout(HtmlReport& report, bool is_synthetic, const std::string& name);

// Opens a page: a frame as recorded (or synthetic), simulated and overlaid, then the result in two sentences.
// `caption`: which frame it is, such as "after the fit".
void AddOpening(HtmlReport& report, const workflow::ComparedFrame& frame, const std::string& caption,
                bool real_is_synthetic, const std::vector<std::string>& sentences);

// Adds the few most important numbers.
void AddKeyFigures(HtmlReport& report, const metrics::MetricsReport& metrics);

// Adds means over frames and pooled figures with their intervals and the noise floor, and a table of frames.
// Must be within a section.
void AddMetricTables(HtmlReport& report, const metrics::MetricsReport& metrics);

// Adds the same figures before and after a change, side by side: means over the same frames.
void AddBeforeAfterTable(HtmlReport& report, const metrics::MetricsReport& before,
                         const metrics::MetricsReport& after, const std::string& caption);

// Explains the colours of overlays and regions, once per page. `real`: name of the real side.
void AddPictureLegend(HtmlReport& report, const std::string& real);

// Adds recorded (or synthetic), simulated, overlay and regions of one frame, polar and fan.
void AddFramePictures(HtmlReport& report, const workflow::ComparedFrame& frame, const std::string& caption,
                      bool real_is_synthetic);

// Adds a section that explains the numbers, the segmentation and the noise floor.
void AddMetricDefinitions(HtmlReport& report, const metrics::MetricsReport& metrics);

}  // namespace sonarcal::report
