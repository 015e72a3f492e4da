#include "apps/report/html/paper_files.h"

#include <fmt/format.h>

#include "apps/report/html/table_text.h"
#include "data_io/files/atomic_output.h"

namespace sonarcal::report {
namespace {

constexpr std::size_t kLongTable = 20;

}  // namespace

std::string SummaryMarkdown(const HtmlReport& report) {
  std::string text = fmt::format("# {}\n\n{}\n\n", report.title(), report.subtitle());
  for (const std::string& synthetic : report.synthetic_callouts()) text += fmt::format("> {}\n\n", synthetic);
  if (!report.key_figures().empty()) {
    Table table{.caption = "At a glance", .columns = {{"Figure"}, {"Value"}, {"", {}, false}}, .rows = {}};
    for (const KeyFigure& figure : report.key_figures()) {
      const std::string unit = figure.unit.empty() ? std::string() : " " + figure.unit;
      table.rows.push_back({{figure.label, figure.value + unit, figure.note}});
    }
    text += MarkdownTable(table);
  }
  for (const Table& table : report.tables()) {
    if (table.rows.size() <= kLongTable) text += MarkdownTable(table);
  }
  return text;
}

void WriteReport(const HtmlReport& report, const std::filesystem::path& folder) {
  report.Write(folder / "report.html");
  WritePaperFiles(report, folder);
}

void WritePaperFiles(const HtmlReport& report, const std::filesystem::path& folder) {
  data_io::WriteFileWhole(folder / "summary.md", SummaryMarkdown(report));
  if (!report.tables().empty()) std::filesystem::create_directories(folder / "tables");
  for (std::size_t i = 0; i < report.tables().size(); ++i) {
    const std::string stem = fmt::format("table_{}", i + 1);
    data_io::WriteFileWhole(folder / "tables" / (stem + ".tex"), LatexTable(report.tables()[i]));
    data_io::WriteFileWhole(folder / "tables" / (stem + ".csv"), CsvTable(report.tables()[i]));
  }
  if (!report.chart_figures().empty() || !report.waterfalls().empty())
    std::filesystem::create_directories(folder / "figures");
  for (const HtmlReport::ChartFigure& figure : report.chart_figures()) {
    for (std::size_t i = 0; i < figure.charts.size(); ++i) {
      const std::string name = figure.charts.size() == 1
                                   ? fmt::format("figure_{}.svg", figure.number)
                                   : fmt::format("figure_{}_{}.svg", figure.number, i + 1);
      data_io::WriteFileWhole(folder / "figures" / name, LineChartSvg(figure.charts[i]));
    }
  }
  for (const HtmlReport::WaterfallFigure& figure : report.waterfalls()) {
    data_io::WriteFileWhole(folder / "figures" / fmt::format("figure_{}.svg", figure.number),
                            WaterfallSvg(figure.waterfall));
  }
}

}  // namespace sonarcal::report
