// Results from static frames (apps/workflow/still_poses.h), for terminals, for fit.json and for reports.
#pragma once

#include <string>

#include "apps/report/html/html_report.h"
#include "apps/workflow/still_poses.h"

namespace sonarcal::report {

// Returns lines of a summary, each with a newline; empty without repeated poses.
std::string StillText(const workflow::StillPoses& still);

// Returns the members `still` and `still_refused` of fit.json as JSON text, without braces around them.
std::string StillMembers(const workflow::StillPoses& still);

// Must be within a section.
void AddStillPoses(HtmlReport& report, const workflow::StillPoses& still);

}  // namespace sonarcal::report
