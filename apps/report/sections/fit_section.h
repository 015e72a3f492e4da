// A fit (apps/workflow/fit.h) as sections of a report, for every command that fits.
#pragma once

#include <string>
#include <vector>

#include "apps/report/html/html_report.h"
#include "apps/workflow/fit.h"

namespace sonarcal::report {

// Opens a page with a frame after the fit and the result in two sentences. Only the sentences if the fit kept
// no images.
void AddFitOpening(HtmlReport& report, const workflow::RecordingFit& fit,
                   const std::vector<std::string>& sentences, const std::string& name = "the fit");

// Returns the agreement after and before the fit, in two sentences. `name`: of the fit.
std::vector<std::string> FitInWords(const workflow::RecordingFit& fit, const std::string& name = "the fit");

// Adds the warnings of the fit, before any figure.
void AddFitWarnings(HtmlReport& report, const calib::FitReport& fit, const std::string& model = {});

// Adds the few most important numbers: agreement before and after.
void AddFitKeyFigures(HtmlReport& report, const workflow::RecordingFit& fit);

// Adds metrics and pictures with the initial and the fitted parameters, on the held-out frames. Must be
// within a section.
void AddFitComparison(HtmlReport& report, const workflow::RecordingFit& fit);

// Adds maps of the pixels with reduced weight; nothing if all weights are 1.
void AddUnexplained(HtmlReport& report, const workflow::RecordingFit& fit);

// Adds values with sigma and status, the gauge, directions that the data do not determine, backscatter curves
// and residuals. Must be within a section.
void AddFittedValues(HtmlReport& report, const workflow::RecordingFit& fit);

// Makes texts such as "0, 1 and 2"; "none" for an empty list.
std::string FrameList(const std::vector<int>& frames);

// As above, after "frame" or "frames".
std::string NamedFrames(const std::vector<int>& frames);

}  // namespace sonarcal::report
