// The section of a target's case in the report of `reproduce`.
#pragma once

#include <string>
#include <vector>

#include "apps/report/html/html_report.h"
#include "apps/reproduce/summary_rows.h"

namespace sonarcal::reproduce {

void AddTarget(report::HtmlReport& report, const TargetComparison& target);

// Table of all things that the case knows beforehand, with their origins. Adds nothing if there are none.
void AddKnown(report::HtmlReport& report, const CasePlan& plan);

// Occupancy and intensity errors of the polar image, one row per image.
report::Table RowTable(const std::vector<SummaryRow>& rows, const std::string& caption,
                       std::vector<std::string> notes);

}  // namespace sonarcal::reproduce
