// What still frames tell (apps/still_poses.h), for terminals, for fit.json and for reports.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "apps/report/html_report.h"
#include "apps/still_poses.h"

namespace sonarcal {

// Lines of a summary, each ended; empty where no pose is shown twice.
std::string StillText(const StillPoses& still);

// The members `still` and `still_refused` of fit.json.
nlohmann::ordered_json StillJson(const StillPoses& still);

// Within a section.
void AddStillPoses(HtmlReport& report, const StillPoses& still);

}  // namespace sonarcal
