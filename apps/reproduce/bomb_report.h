// The bomb's section in the report of `reproduce`.
#pragma once

#include <string>
#include <vector>

#include "apps/report/html/html_report.h"
#include "apps/reproduce/summary_rows.h"

namespace sonarcal::reproduce {

void AddBomb(report::HtmlReport& report, const BombComparison& bomb);

// Occupancy and intensity errors of the polar image, a row a way to simulate.
report::Table RowTable(const std::vector<SummaryRow>& rows, const std::string& caption,
                       std::vector<std::string> notes);

}  // namespace sonarcal::reproduce
