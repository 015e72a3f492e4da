#include "apps/report/html/table_text.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>
#include <vector>

#include "apps/report/html/html_text.h"

namespace sonarcal::report {
namespace {

constexpr std::string_view kAbsent = "–";

using Replacements = std::vector<std::pair<std::string_view, std::string_view>>;

// Replaces the first match at each place.
std::string Replaced(std::string_view text, const Replacements& replacements) {
  std::string out;
  while (!text.empty()) {
    std::string_view from = text.substr(0, 1);
    std::string_view to = from;
    for (const auto& [what, by] : replacements) {
      if (!text.starts_with(what)) continue;
      from = what;
      to = by;
      break;
    }
    out += to;
    text.remove_prefix(from.size());
  }
  return out;
}

std::string Latex(std::string_view text) {
  static const Replacements kSpecial = {{"\\", "\\textbackslash{}"},
                                        {"&", "\\&"},
                                        {"%", "\\%"},
                                        {"$", "\\$"},
                                        {"#", "\\#"},
                                        {"_", "\\_"},
                                        {"{", "\\{"},
                                        {"}", "\\}"},
                                        {"~", "\\textasciitilde{}"},
                                        {"^", "\\^{}"},
                                        {"<", "$<$"},
                                        {">", "$>$"},
                                        {"|", "$|$"},
                                        {kMinus, "$-$"},
                                        {kAbsent, "--"},
                                        {"±", "$\\pm$"},
                                        {"°", "$^\\circ$"},
                                        {"σ", "$\\sigma$"},
                                        {"θ", "$\\theta$"},
                                        {"→", "$\\to$"},
                                        {"×", "$\\times$"},
                                        {"²", "$^2$"},
                                        {"≤", "$\\le$"},
                                        {"≥", "$\\ge$"},
                                        {"\n", " "}};
  return Replaced(text, kSpecial);
}

std::string Markdown(std::string_view text) {
  static const Replacements kSpecial = {{"\\", "\\\\"}, {"|", "\\|"},  {"*", "\\*"}, {"_", "\\_"},
                                        {"`", "\\`"},   {"<", "&lt;"}, {"[", "\\["}, {"\n", " "}};
  return Replaced(text, kSpecial);
}

std::string Csv(std::string_view text) {
  if (text == kAbsent) return {};
  std::string plain = Replaced(text, {{kMinus, "-"}});
  if (plain.find_first_of(",\"\n\r") == std::string::npos) return plain;
  return fmt::format("\"{}\"", Replaced(plain, {{"\"", "\"\""}}));
}

std::string Bold(const std::string& text, RowStyle style, std::string_view before, std::string_view after) {
  const bool bold = style == RowStyle::kStrong || style == RowStyle::kGroup;
  return bold && !text.empty() ? fmt::format("{}{}{}", before, text, after) : text;
}

std::vector<std::string> Headings(const Table& table, std::string (*escape)(std::string_view)) {
  std::vector<std::string> headings;
  for (const TableColumn& column : table.columns) {
    headings.push_back(
        escape(column.unit.empty() ? column.title : fmt::format("{} ({})", column.title, column.unit)));
  }
  return headings;
}

}  // namespace

std::string LatexTable(const Table& table) {
  std::string alignment = "l";
  for (std::size_t i = 1; i < table.columns.size(); ++i) alignment += table.columns[i].numeric ? 'r' : 'l';
  std::string text = fmt::format(
      "\\begin{{table}}\n\\centering\n\\caption{{{}}}\n\\begin{{tabular}}{{{}}}\n\\toprule\n{} "
      "\\\\\n\\midrule\n",
      Latex(table.caption), alignment, fmt::join(Headings(table, Latex), " & "));
  for (const TableRow& row : table.rows) {
    if (row.style == RowStyle::kGroup) {
      text += fmt::format("\\addlinespace\n\\multicolumn{{{}}}{{l}}{{\\emph{{{}}}}} \\\\\n",
                          table.columns.size(), Latex(row.cells.front()));
      continue;
    }
    std::vector<std::string> cells;
    for (const std::string& cell : row.cells) cells.push_back(Bold(Latex(cell), row.style, "\\textbf{", "}"));
    text += fmt::format("{} \\\\\n", fmt::join(cells, " & "));
  }
  text += "\\bottomrule\n\\end{tabular}\n";
  for (const std::string& note : table.notes) text += fmt::format("\\par\\footnotesize {}\n", Latex(note));
  return text + "\\end{table}\n";
}

std::string MarkdownTable(const Table& table) {
  std::string rule = "|---|";
  for (std::size_t i = 1; i < table.columns.size(); ++i) rule += table.columns[i].numeric ? "---:|" : "---|";
  std::string text = fmt::format("**{}**\n\n| {} |\n{}\n", Markdown(table.caption),
                                 fmt::join(Headings(table, Markdown), " | "), rule);
  for (const TableRow& row : table.rows) {
    std::vector<std::string> cells;
    for (const std::string& cell : row.cells) cells.push_back(Bold(Markdown(cell), row.style, "**", "**"));
    cells.resize(table.columns.size());  // the row of a group has one cell
    text += fmt::format("| {} |\n", fmt::join(cells, " | "));
  }
  text += "\n";
  for (const std::string& note : table.notes) text += fmt::format("{}\n\n", Markdown(note));
  return text;
}

std::string CsvTable(const Table& table) {
  std::string text = fmt::format("{}\r\n", fmt::join(Headings(table, Csv), ","));
  for (const TableRow& row : table.rows) {
    std::vector<std::string> cells;
    for (const std::string& cell : row.cells) cells.push_back(Csv(cell));
    text += fmt::format("{}\r\n", fmt::join(cells, ","));
  }
  return text;
}

}  // namespace sonarcal::report
