// What still frames tell (apps/still_poses.h), for terminals, for fit.json and for reports.
#pragma once

#include <string>

#include "apps/report/html_report.h"
#include "apps/still_poses.h"

namespace sonarcal {

// Lines of a summary, each ended; empty where no pose is shown twice.
std::string StillText(const StillPoses& still);

// The members `still` and `still_refused` of fit.json, as JSON text without the braces around them.
std::string StillMembers(const StillPoses& still);

// Within a section.
void AddStillPoses(HtmlReport& report, const StillPoses& still);

}  // namespace sonarcal
