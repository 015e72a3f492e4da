// Poses that a search found (apps/workflow/locate.h), for terminals and for reports.
#pragma once

#include <string>

#include "apps/report/html/html_report.h"
#include "apps/workflow/locate.h"

namespace sonarcal::report {

// Adds a table of the candidates, best first. Must be within a section.
void AddCandidates(HtmlReport& report, const calib::PoseSearchResult& search);

// Opens with the best pose of the first frame. Then adds a section for each frame: candidates, what is open,
// and the recorded image beside the expected one of the first candidates.
void AddLocation(HtmlReport& report, const workflow::Location& location, bool real_is_synthetic,
                 const std::string& recording);

// Summary of a frame for a terminal, with newlines.
std::string LocatedText(const workflow::LocatedFrame& frame);

}  // namespace sonarcal::report
