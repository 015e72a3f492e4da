// Result of a fit to a standard target (calib/standard_target/standard_target_fit.h), for terminals, for
// fit.json and for reports.
#pragma once

#include <string>
#include <vector>

#include "apps/report/html/html_report.h"
#include "calib/standard_target/standard_target_fit.h"
#include "core/types/image.h"

namespace sonarcal::report {

// Returns the level and the frames that show it, in two or three sentences.
std::vector<std::string> StandardTargetInWords(const calib::StandardTargetFit& fit);

// Returns lines of a summary, each with a newline.
std::string StandardTargetText(const calib::StandardTargetFit& fit);

// Returns the member `standard_target` of fit.json as JSON text, without braces around it.
std::string StandardTargetMember(const calib::StandardTargetFit& fit);

// Adds sections: the sphere as recorded and as fitted, levels by frame, sensitivities, parameters, frames
// left out. `axes`: of the recording.
void AddStandardTarget(HtmlReport& report, const calib::StandardTargetFit& fit, const PolarAxes& axes,
                       bool is_synthetic);

}  // namespace sonarcal::report
