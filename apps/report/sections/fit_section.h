// A fit (apps/workflow/fit.h) as sections of a report, for every command that fits.
#pragma once

#include <string>

#include "apps/report/html/html_report.h"
#include "apps/workflow/fit.h"

namespace sonarcal::report {

// Adds the warnings of the fit, before any figure.
void AddFitWarnings(HtmlReport& report, const calib::FitReport& fit, const std::string& model = {});

// The few numbers to look at first: agreement before and after.
void AddFitKeyFigures(HtmlReport& report, const workflow::RecordingFit& fit);

// Metrics and pictures with the initial and the fitted parameters, on the frames the fit did not see. Within
// a section.
void AddFitComparison(HtmlReport& report, const workflow::RecordingFit& fit);

// Maps of the pixels that count less; nothing where all count in full.
void AddUnexplained(HtmlReport& report, const workflow::RecordingFit& fit);

// Values with sigma and status, the gauge, what the data leave open, backscatter curves, residuals. Within a
// section.
void AddFittedValues(HtmlReport& report, const workflow::RecordingFit& fit);

// "0, 1 and 2", or "none".
std::string FrameList(const std::vector<int>& frames);

}  // namespace sonarcal::report
