// A report's tables and charts as files beside it, for a paper or a pull request:
//
//   tables/table_1.tex, .csv     each table of the page, by its number there
//   figures/figure_2_1.svg       each chart of each figure of charts
//   summary.md                   what is synthetic, key figures and the short tables
#pragma once

#include <filesystem>

#include "apps/report/html/html_report.h"

namespace sonarcal::report {

// Both throw DataError where a file can't be written.
//
// report.html and the files below.
void WriteReport(const HtmlReport& report, const std::filesystem::path& folder);
void WritePaperFiles(const HtmlReport& report, const std::filesystem::path& folder);

// The summary alone; tables of more than 20 rows are left to the page.
std::string SummaryMarkdown(const HtmlReport& report);

}  // namespace sonarcal::report
