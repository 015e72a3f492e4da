#include "apps/report/html/html_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <iterator>

#include "apps/report/html/html_text.h"
#include "apps/report/html/report_css.h"
#include "apps/report/html/report_script.h"
#include "data_io/files/atomic_output.h"
#include "data_io/images/image_io.h"
#include "data_io/pictures/picture.h"

namespace sonarcal::report {
namespace {

template <typename... Args>
void Append(std::string& out, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(out), format, std::forward<Args>(args)...);
}

std::string_view CssClass(CalloutKind kind) {
  switch (kind) {
    case CalloutKind::kNote:
      return "note";
    case CalloutKind::kSynthetic:
      return "synthetic";
    case CalloutKind::kLimit:
      return "limit";
    case CalloutKind::kWarning:
      return "warning";
  }
  return "note";
}

std::string_view CssClass(RowStyle style) {
  switch (style) {
    case RowStyle::kPlain:
      return "plain";
    case RowStyle::kStrong:
      return "strong";
    case RowStyle::kMuted:
      return "muted";
    case RowStyle::kGroup:
      return "group";
  }
  return "plain";
}

std::string TableHeadHtml(const std::vector<TableColumn>& columns) {
  std::string html = "<thead><tr>";
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const bool right = columns[i].numeric && i > 0;
    Append(html, "<th scope=\"col\"{}>{}", right ? " class=\"number\"" : "", EscapeHtml(columns[i].title));
    if (!columns[i].unit.empty()) Append(html, "<span class=\"unit\">{}</span>", EscapeHtml(columns[i].unit));
    html += "</th>";
  }
  return html + "</tr></thead>";
}

std::string TableRowHtml(const TableRow& row, const std::vector<TableColumn>& columns) {
  if (row.style == RowStyle::kGroup) {
    SONARCAL_CHECK(row.cells.size() == 1, "a group row of {} cells", row.cells.size());
    return fmt::format("<tr class=\"group\"><th scope=\"colgroup\" colspan=\"{}\">{}</th></tr>",
                       columns.size(), EscapeHtml(row.cells.front()));
  }
  SONARCAL_CHECK(row.cells.size() == columns.size(), "a row of {} cells in a table of {} columns",
                 row.cells.size(), columns.size());
  std::string html = fmt::format("<tr class=\"{}\"><th scope=\"row\">{}</th>", CssClass(row.style),
                                 EscapeHtml(row.cells.front()));
  for (std::size_t i = 1; i < columns.size(); ++i) {
    Append(html, "<td{}>{}</td>", columns[i].numeric ? " class=\"number\"" : "", EscapeHtml(row.cells[i]));
  }
  return html + "</tr>\n";
}

// Size and kind of a PNG, from its header. With the size the page reserves the space before the picture is
// decoded.
StoredPicture ReadHeader(const std::vector<std::uint8_t>& png) {
  static constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  SONARCAL_CHECK(png.size() > 24 && std::equal(kSignature.begin(), kSignature.end(), png.begin()),
                 "a picture of {} bytes is not a PNG file", png.size());
  const auto big_endian = [&](std::size_t offset) {
    return static_cast<int>(std::uint32_t{png[offset]} << 24 | std::uint32_t{png[offset + 1]} << 16 |
                            std::uint32_t{png[offset + 2]} << 8 | std::uint32_t{png[offset + 3]});
  };
  return {.id = {}, .rows = big_endian(20), .cols = big_endian(16), .is_grey = png[25] == 0};
}

std::size_t Hash(const std::vector<std::uint8_t>& png) {
  return std::hash<std::string_view>{}({reinterpret_cast<const char*>(png.data()), png.size()});
}

// Hash of what a picture shows.
std::size_t Hash(const Picture& picture) {
  if (!picture.plot) return Hash(picture.png);
  return std::hash<std::string>{}(fmt::format("{} {} {} {}", Hash(picture.png), Hash(picture.plot->simulated),
                                              static_cast<int>(picture.plot->view),
                                              static_cast<int>(picture.plot->colours)));
}

bool ShowsOneColour(const Picture& picture) {
  return IsOneColour(picture.png) &&
         (!picture.plot || picture.plot->simulated.empty() || IsOneColour(picture.plot->simulated));
}

// Hash in the form of a Content-Security-Policy.
std::string ScriptHashBase64() {
  std::array<std::uint8_t, 32> hash = {};
  SONARCAL_CHECK(kReportScriptSha256.size() == 2 * hash.size(), "a hash of {} digits",
                 kReportScriptSha256.size());
  for (std::size_t i = 0; i < hash.size(); ++i) {
    const std::string_view digits = kReportScriptSha256.substr(2 * i, 2);
    std::from_chars(digits.begin(), digits.end(), hash[i], 16);
  }
  return Base64(hash);
}

std::string LegendHtml(const std::vector<LegendEntry>& legend) {
  if (legend.empty()) return {};
  std::string html = "<ul class=\"legend\">";
  for (const LegendEntry& entry : legend) {
    Append(html, "<li><span class=\"swatch\" style=\"background:{}\"></span>{}</li>",
           EscapeHtml(entry.colour), EscapeHtml(entry.label));
  }
  return html + "</ul>";
}

}  // namespace

HtmlReport::HtmlReport(std::string title, std::string subtitle)
    : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

void HtmlReport::Section(std::string_view title) {
  AddHeading(2, title);
}

void HtmlReport::Subsection(std::string_view title) {
  SONARCAL_CHECK(!headings_.empty(), "subsection '{}' before any section", title);
  AddHeading(3, title);
}

void HtmlReport::AddHeading(int level, std::string_view title) {
  std::string anchor = Slug(title);
  const auto taken = [&](const std::string& name) {
    return std::any_of(headings_.begin(), headings_.end(),
                       [&](const Heading& heading) { return heading.anchor == name; });
  };
  if (taken(anchor)) anchor += fmt::format("-{}", headings_.size() + 1);
  Append(body_, "<h{} id=\"{}\">{}</h{}>\n", level, anchor, EscapeHtml(title), level);
  headings_.push_back({level, std::string(title), anchor});
}

bool IsOneColour(const std::vector<std::uint8_t>& png) {
  ReadHeader(png);  // checks that it is a PNG
  const data_io::ImageFile file({reinterpret_cast<const char*>(png.data()), png.size()}, "picture");
  const RgbImage image = file.DecodeRgb();
  const auto is_outside = [](const data_io::Rgb& colour) { return colour == data_io::kOutsideColor; };
  const auto first = std::find_if_not(image.values().begin(), image.values().end(), is_outside);
  return std::all_of(first, image.values().end(),
                     [&](const data_io::Rgb& colour) { return colour == *first || is_outside(colour); });
}

void HtmlReport::Paragraph(std::string_view text) {
  Append(body_, "<p>{}</p>\n", EscapeHtml(text));
}

void HtmlReport::ParagraphOnce(std::string_view text) {
  if (said_once_.emplace(text).second) Paragraph(text);
}

void HtmlReport::List(const std::vector<std::string>& items) {
  if (items.empty()) return;
  body_ += "<ul class=\"list\">";
  for (const std::string& item : items) Append(body_, "<li>{}</li>", EscapeHtml(item));
  body_ += "</ul>\n";
}

void HtmlReport::Facts(const std::vector<std::pair<std::string, std::string>>& facts) {
  if (facts.empty()) return;
  body_ += "<dl class=\"facts\">";
  for (const auto& [name, value] : facts) {
    Append(body_, "<div><dt>{}</dt><dd>{}</dd></div>", EscapeHtml(name), EscapeHtml(value));
  }
  body_ += "</dl>\n";
}

void HtmlReport::Callout(CalloutKind kind, std::string_view title, std::string_view text) {
  if (kind == CalloutKind::kSynthetic) synthetic_callouts_.push_back(fmt::format("{}. {}", title, text));
  Append(body_, "<aside class=\"callout {}\"><strong>{}</strong><p>{}</p></aside>\n", CssClass(kind),
         EscapeHtml(title), EscapeHtml(text));
}

void HtmlReport::KeyFigures(const std::vector<KeyFigure>& figures) {
  if (figures.empty()) return;
  key_figures_.insert(key_figures_.end(), figures.begin(), figures.end());
  body_ += "<dl class=\"key-figures\">";
  for (const KeyFigure& figure : figures) {
    Append(body_, "<div><dt>{}</dt><dd><span class=\"value\">{}</span>", EscapeHtml(figure.label),
           EscapeHtml(figure.value));
    if (!figure.unit.empty()) Append(body_, " <span class=\"unit\">{}</span>", EscapeHtml(figure.unit));
    if (!figure.note.empty()) Append(body_, "<span class=\"aside\">{}</span>", EscapeHtml(figure.note));
    body_ += "</dd></div>";
  }
  body_ += "</dl>\n";
}

void HtmlReport::Add(const Table& table) {
  SONARCAL_CHECK(!table.columns.empty(), "table '{}' has no columns", table.caption);
  tables_.push_back(table);
  const std::string caption = EscapeHtml(table.caption);
  // Wide tables scroll within a frame that the keyboard can reach.
  Append(body_, "<figure class=\"table\"><figcaption><b>Table {}.</b> {}</figcaption>", tables_.size(),
         caption);
  Append(body_, "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\"><table>{}<tbody>\n",
         caption, TableHeadHtml(table.columns));
  for (const TableRow& row : table.rows) body_ += TableRowHtml(row, table.columns);
  body_ += "</tbody></table></div>";
  for (const std::string& note : table.notes)
    Append(body_, "<p class=\"table-note\">{}</p>", EscapeHtml(note));
  body_ += "</figure>\n";
}

StoredPicture HtmlReport::Store(const std::vector<std::uint8_t>& png) {
  const auto [at, is_new] = stored_.try_emplace(Hash(png), ReadHeader(png));
  if (is_new) {
    at->second.id = fmt::format("picture-{}", stored_.size());
    Append(body_,
           "<svg class=\"data\" width=\"0\" height=\"0\" aria-hidden=\"true\"><defs><image id=\"{}\" "
           "width=\"{}\" height=\"{}\" href=\"data:image/png;base64,{}\"/></defs></svg>\n",
           at->second.id, at->second.cols, at->second.rows, Base64(png));
  }
  return at->second;
}

std::string HtmlReport::PictureHtml(const Picture& picture, const std::string& letter) {
  const std::string& alt = picture.alt.empty() ? picture.caption : picture.alt;
  std::string drawing;
  if (picture.plot) {
    std::vector<StoredPicture> stored = {Store(picture.png)};
    if (!picture.plot->simulated.empty()) stored.push_back(Store(picture.plot->simulated));
    drawing = SonarPlotSvg(*picture.plot, stored, ++plot_count_, alt);
  } else {
    const StoredPicture header = ReadHeader(picture.png);
    drawing = fmt::format("<img{} width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\"/>",
                          picture.crisp ? " class=\"crisp\"" : "", header.cols, header.rows, EscapeHtml(alt),
                          Base64(picture.png));
  }
  return fmt::format("<figure class=\"picture\">{}<figcaption>{}{}</figcaption></figure>\n", drawing, letter,
                     EscapeHtml(picture.caption));
}

void HtmlReport::Add(const PictureRow& row) {
  SONARCAL_CHECK(!row.pictures.empty() && row.columns > 0, "{} pictures in {} columns", row.pictures.size(),
                 row.columns);
  std::vector<const Picture*> shown;
  std::string caption = row.caption;
  for (const Picture& picture : row.pictures) {
    if (ShowsOneColour(picture)) {
      caption += fmt::format(" {}: a single colour, not shown.", picture.caption);
      continue;
    }
    const auto [at, is_new] = pictured_in_.try_emplace(Hash(picture), figure_count_ + 1);
    if (is_new) {
      shown.push_back(&picture);
    } else if (at->second <= figure_count_) {
      caption += fmt::format(" {}: as in figure {}.", picture.caption, at->second);
    } else {
      const auto same =
          std::ranges::find(shown, Hash(picture), [](const Picture* other) { return Hash(*other); });
      caption += fmt::format(" {}: the same picture as {}.", picture.caption, (*same)->caption);
    }
  }
  if (shown.empty()) {
    Paragraph(caption);
    return;
  }
  const int columns = std::min(row.columns, static_cast<int>(shown.size()));
  std::string pictures;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const bool lettered = shown.size() > 1 && i < 26;
    pictures += PictureHtml(*shown[i],
                            lettered ? fmt::format("<b>{}</b> ", static_cast<char>('a' + i)) : std::string());
  }
  Append(body_, "<figure class=\"pictures\"><div class=\"columns\" style=\"--columns:{}\">\n{}", columns,
         pictures);
  Append(body_, "</div>{}<figcaption><b>Figure {}.</b> {}</figcaption></figure>\n", LegendHtml(row.legend),
         ++figure_count_, EscapeHtml(caption));
}

void HtmlReport::Add(const std::vector<LineChart>& charts, std::string_view caption) {
  SONARCAL_CHECK(!charts.empty(), "a figure without charts: {}", caption);
  body_ += "<figure class=\"charts\"><div class=\"row\">\n";
  for (const LineChart& chart : charts) body_ += LineChartHtml(chart);
  chart_figures_.push_back({++figure_count_, std::string(caption), charts});
  Append(body_, "</div><figcaption><b>Figure {}.</b> {}</figcaption></figure>\n", figure_count_,
         EscapeHtml(caption));
}

void HtmlReport::Add(const Waterfall& waterfall, std::string_view caption) {
  waterfalls_.push_back({++figure_count_, waterfall});
  Append(body_, "<figure class=\"charts\">\n{}<figcaption><b>Figure {}.</b> {}</figcaption></figure>\n",
         WaterfallHtml(waterfall), figure_count_, EscapeHtml(caption));
}

void HtmlReport::Add(const FrameViewer& viewer) {
  const std::string html =
      FrameViewerHtml(viewer, ++viewer_count_, [this](const auto& png) { return Store(png).id; });
  Append(body_, "<figure class=\"viewers\">{}<figcaption><b>Figure {}.</b> {}</figcaption></figure>\n", html,
         ++figure_count_, EscapeHtml(viewer.caption));
}

void HtmlReport::Code(std::string_view text) {
  Append(body_, "<pre><code>{}</code></pre>\n", EscapeHtml(text));
}

void HtmlReport::Details(std::string_view summary, std::string_view text) {
  Append(body_, "<details><summary>{}</summary><pre><code>{}</code></pre></details>\n", EscapeHtml(summary),
         EscapeHtml(text));
}

std::string HtmlReport::ContentsHtml() const {
  if (headings_.size() < 2) return {};
  // Without room beside the page, the list is closed until the box is ticked (report.css), without a script.
  std::string html =
      "<nav aria-label=\"Contents\"><label><input type=\"checkbox\"/><strong>Contents</strong></label><ol>";
  for (std::size_t i = 0; i < headings_.size(); ++i) {
    const Heading& heading = headings_[i];
    Append(html, "<li><a href=\"#{}\">{}</a>", heading.anchor, EscapeHtml(heading.title));
    // The list of a subsection opens within the item of its section and closes with the last of them.
    const int next_level = i + 1 < headings_.size() ? headings_[i + 1].level : 2;
    if (next_level > heading.level) {
      html += "<ol>";
    } else {
      html += next_level < heading.level ? "</li></ol></li>" : "</li>";
    }
  }
  return html + "</ol></nav>\n";
}

std::string HtmlReport::Html() const {
  const std::string title = EscapeHtml(title_);
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n";
  html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n";
  html += "<meta name=\"color-scheme\" content=\"light dark\"/>\n";
  // Protects against injected text: the browser fetches nothing and runs only the script of viewers and
  // charts, which is allowed by its hash.
  const bool has_script = viewer_count_ > 0 || !chart_figures_.empty();
  Append(html,
         "<meta http-equiv=\"Content-Security-Policy\" "
         "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'{}\"/>\n",
         has_script ? fmt::format("; script-src 'sha256-{}'", ScriptHashBase64()) : std::string());
  Append(html, "<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n", title, kReportCss);
  Append(html, "<header><h1>{}</h1>", title);
  if (!subtitle_.empty()) Append(html, "<p class=\"subtitle\">{}</p>", EscapeHtml(subtitle_));
  html += "</header>\n";
  html += ContentsHtml();
  if (!stored_.empty()) html += SonarDefinitionsSvg();
  Append(html, "<main>\n{}</main>\n", body_);
  if (!footer_.empty()) Append(html, "<footer>{}</footer>\n", EscapeHtml(footer_));
  if (has_script) Append(html, "<script>{}</script>\n", kReportScript);
  html += "</body>\n</html>\n";
  return html;
}

void HtmlReport::Write(const std::filesystem::path& path) const {
  data_io::WriteFileWhole(path, Html());
}

}  // namespace sonarcal::report
