// Changes since an earlier comparison (metrics/json/against.h), as a part of a report.
#pragma once

#include "apps/report/html/html_report.h"
#include "metrics/json/against.h"

namespace sonarcal::report {

// Adds a table of the headline figures and of those that changed. Must be within a section.
void AddAgainst(HtmlReport& report, const metrics::Against& against);

}  // namespace sonarcal::report
