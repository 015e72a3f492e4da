// A report as one HTML file that opens offline. It makes no request, embeds its pictures, each once, and has
// no script except that of frame viewers and charts. It follows the light or dark setting, prints, and fits a
// phone.
//
//   HtmlReport report("Tank comparison", "12 frames, simulated with the paper model");
//   report.Section("Occupancy");
//   report.Paragraph("Ratios of pixel counts; 1 is best.");
//   report.Add(Table{.caption = "...", .columns = {{"Frame"}, {"IoU"}}, .rows = {{{"0", "0.82"}}}});
//   report.Write(out / "report.html");
//
// Content appears in the order of the calls. All text is plain text; it is escaped here, and only here.
// Sections and subsections make the table of contents. Tables and figures are numbered.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/report/html/frame_viewer.h"
#include "apps/report/html/line_chart.h"
#include "apps/report/html/sonar_plot.h"
#include "apps/report/html/waterfall.h"

namespace sonarcal::report {

enum class CalloutKind {
  kNote,
  kSynthetic,  // the data were simulated, not recorded
  kLimit,      // a limit of a result
  kWarning,    // an error that the reader must know
};

struct TableColumn {
  std::string title;
  std::string unit = {};  // shown below the title
  bool numeric = true;    // right-aligned, digits of equal width; the first column is always left-aligned
};

enum class RowStyle {
  kPlain,
  kStrong,  // the main row: a mean, the fitted value
  kMuted,   // for comparison only, such as published values
  kGroup,   // one cell, the heading of the rows below it
};

struct TableRow {
  std::vector<std::string> cells;  // one per column, formatted by the caller (see FormatNumber)
  RowStyle style = RowStyle::kPlain;
};

struct Table {
  std::string caption;
  std::vector<TableColumn> columns;
  std::vector<TableRow> rows;
  std::vector<std::string> notes = {};  // below the table: definitions, sources, what is synthetic
};

struct Picture {
  std::vector<std::uint8_t> png;       // encoded file, shown at its own size or smaller; enlarge it before
  std::string caption;                 // short: "Recorded", "Simulated", "Overlay"
  std::string alt = {};                // description for screen readers; empty: the caption
  bool crisp = false;                  // enlarges by repeating pixels, without smoothing
  std::optional<SonarPlot> plot = {};  // a sonar image: drawn with axes and a colour bar
};

struct LegendEntry {
  std::string colour;  // colour in the picture: "#rrggbb"
  std::string label;
};

// Returns true if a picture (PNG) has only one colour, outside of a fan excepted. Such a picture shows
// nothing.
bool IsOneColour(const std::vector<std::uint8_t>& png);

// Pictures side by side, with letters a, b, c... and `columns` pictures per row.
struct PictureRow {
  std::string caption;
  std::vector<Picture> pictures;
  int columns = 3;
  std::vector<LegendEntry> legend = {};  // meaning of the colours of an overlay
};

struct KeyFigure {
  std::string label;
  std::string value;
  std::string unit = {};
  std::string note = {};  // such as "was 0.68 before the fit"
};

class HtmlReport {
 public:
  explicit HtmlReport(std::string title, std::string subtitle = {});

  void Section(std::string_view title);
  void Subsection(std::string_view title);  // within a section

  void Paragraph(std::string_view text);
  void ParagraphOnce(std::string_view text);  // no effect if the page already has it
  void List(const std::vector<std::string>& items);
  void Facts(const std::vector<std::pair<std::string, std::string>>& facts);  // name, value
  void Callout(CalloutKind kind, std::string_view title, std::string_view text);
  void KeyFigures(const std::vector<KeyFigure>& figures);
  void Add(const Table& table);
  // A picture that the page already shows is not repeated; the caption refers to it. One with a single colour
  // is not shown.
  void Add(const PictureRow& row);
  void Add(const std::vector<LineChart>& charts, std::string_view caption);  // one numbered figure
  void Add(const FrameViewer& viewer);
  void Add(const Waterfall& waterfall, std::string_view caption);
  void Code(std::string_view text);
  // Adds collapsed text, such as a configuration or a log.
  void Details(std::string_view summary, std::string_view text);

  // Sets the last line of the page: program, version, date.
  void SetFooter(std::string text) { footer_ = std::move(text); }

  // Content in the order of the calls, for writers of other formats (paper_files.h). Table i of the page is
  // tables()[i - 1].
  struct ChartFigure {
    int number = 0;
    std::string caption;
    std::vector<LineChart> charts;
  };
  struct WaterfallFigure {
    int number = 0;
    Waterfall waterfall;
  };
  const std::string& title() const { return title_; }
  const std::string& subtitle() const { return subtitle_; }
  const std::vector<std::string>& synthetic_callouts() const { return synthetic_callouts_; }
  const std::vector<KeyFigure>& key_figures() const { return key_figures_; }
  const std::vector<Table>& tables() const { return tables_; }
  const std::vector<ChartFigure>& chart_figures() const { return chart_figures_; }
  const std::vector<WaterfallFigure>& waterfalls() const { return waterfalls_; }

  std::string Html() const;

  // Throws DataError if the file cannot be written.
  void Write(const std::filesystem::path& path) const;

 private:
  struct Heading {
    int level = 2;
    std::string title;
    std::string anchor;
  };

  void AddHeading(int level, std::string_view title);
  // Puts a picture into the page, or finds the one with the same bytes.
  StoredPicture Store(const std::vector<std::uint8_t>& png);
  std::string PictureHtml(const Picture& picture, const std::string& letter);
  std::string ContentsHtml() const;

  std::string title_;
  std::string subtitle_;
  std::string footer_;
  std::string body_;
  std::vector<Heading> headings_;
  std::vector<std::string> synthetic_callouts_;
  std::vector<KeyFigure> key_figures_;
  std::vector<Table> tables_;
  std::vector<ChartFigure> chart_figures_;
  std::vector<WaterfallFigure> waterfalls_;
  std::set<std::string, std::less<>> said_once_;
  std::map<std::size_t, int> pictured_in_;       // figure number by hash of the picture
  std::map<std::size_t, StoredPicture> stored_;  // by hash of the PNG
  int figure_count_ = 0;
  int viewer_count_ = 0;
  int plot_count_ = 0;
};

}  // namespace sonarcal::report
