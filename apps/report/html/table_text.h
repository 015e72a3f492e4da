// A report's table as text for other pages: a paper (LaTeX, package booktabs), a pull request (Markdown) and
// a program (CSV). The same cells everywhere.
#pragma once

#include <string>

#include "apps/report/html/html_report.h"

namespace sonarcal::report {

// A table environment with its caption; notes stand below the rules. Needs \usepackage{booktabs}.
std::string LatexTable(const Table& table);

// As GitHub and GitLab show tables; rows that count in bold, notes below.
std::string MarkdownTable(const Table& table);

// RFC 4180: a header of "title (unit)", then the rows; group rows head a line of their own. A true minus sign
// becomes a hyphen, an absent value an empty cell.
std::string CsvTable(const Table& table);

}  // namespace sonarcal::report
