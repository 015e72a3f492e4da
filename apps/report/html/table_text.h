// Tables of a report as text: for a paper (LaTeX, package booktabs), a pull request (Markdown) and a program
// (CSV). All have the same cells.
#pragma once

#include <string>

#include "apps/report/html/html_report.h"

namespace sonarcal::report {

// Returns a table environment with its caption; notes are below the rules. Needs \usepackage{booktabs}.
std::string LatexTable(const Table& table);

// Markdown of GitHub and GitLab. Main rows are bold, notes are below.
std::string MarkdownTable(const Table& table);

// CSV of RFC 4180: a header of "title (unit)", then the rows. Group rows have a line of their own. A true
// minus sign becomes a hyphen, an absent value an empty cell.
std::string CsvTable(const Table& table);

}  // namespace sonarcal::report
