// Tables and charts of a report as files beside it, for a paper or a pull request:
//
//   tables/table_1.tex, .csv     each table of the page, by its number there
//   figures/figure_2_1.svg       each chart of each figure of charts
//   summary.md                   statement of synthetic data, key figures and the short tables
#pragma once

#include <filesystem>

#include "apps/report/html/html_report.h"

namespace sonarcal::report {

// WriteReport writes report.html and the files above; WritePaperFiles writes the files above only. Both throw
// DataError if a file cannot be written.
void WriteReport(const HtmlReport& report, const std::filesystem::path& folder);
void WritePaperFiles(const HtmlReport& report, const std::filesystem::path& folder);

// Returns the summary, without tables of more than 20 rows.
std::string SummaryMarkdown(const HtmlReport& report);

}  // namespace sonarcal::report
