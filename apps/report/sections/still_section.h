// What still frames tell (apps/workflow/still_poses.h), for terminals, for fit.json and for reports.
#pragma once

#include <string>

#include "apps/report/html/html_report.h"
#include "apps/workflow/still_poses.h"

namespace sonarcal::report {

// Lines of a summary, each ended; empty where no pose is shown twice.
std::string StillText(const workflow::StillPoses& still);

// The members `still` and `still_refused` of fit.json, as JSON text without the braces around them.
std::string StillMembers(const workflow::StillPoses& still);

// Within a section.
void AddStillPoses(HtmlReport& report, const workflow::StillPoses& still);

}  // namespace sonarcal::report
