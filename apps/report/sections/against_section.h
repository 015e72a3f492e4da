// What changed since an earlier comparison (metrics/json/against.h), as a part of a report.
#pragma once

#include "apps/report/html/html_report.h"
#include "metrics/json/against.h"

namespace sonarcal::report {

// A table of the headline figures and of those that got better or worse. Within a section.
void AddAgainst(HtmlReport& report, const metrics::Against& against);

}  // namespace sonarcal::report
