// A fit (apps/fit_recording.h) as sections of a report, for every command that fits.
#pragma once

#include <string>

#include "apps/fit_recording.h"
#include "apps/report/html_report.h"

namespace sonarcal {

// Adds the warnings of the fit, before any figure.
void AddFitWarnings(HtmlReport& report, const FitReport& fit, const std::string& model = {});

// The few numbers to look at first: agreement before and after.
void AddFitKeyFigures(HtmlReport& report, const RecordingFit& fit);

// Metrics and pictures with the initial and the fitted parameters, on the frames the fit did not see. Within
// a section.
void AddFitComparison(HtmlReport& report, const RecordingFit& fit);

// Maps of the pixels that count less; nothing where all count in full.
void AddUnexplained(HtmlReport& report, const RecordingFit& fit);

// Values with sigma and status, the gauge, what the data leave open, backscatter curves, residuals. Within a
// section.
void AddFittedValues(HtmlReport& report, const RecordingFit& fit);

// "0, 1 and 2", or "none".
std::string FrameList(const std::vector<int>& frames);

}  // namespace sonarcal
