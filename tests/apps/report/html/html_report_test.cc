#include "apps/report/html/html_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include <opencv2/imgcodecs.hpp>

#include "apps/report/html/html_text.h"
#include "apps/report/html/paper_files.h"
#include "apps/report/html/table_text.h"
#include "core/types/error.h"
#include "tests/apps/html_check.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kHostile[] = "<script>\"&'</script>\x01\xFF]]> --> {}";

// A picture of a single colour, but for a pixel of another.
std::vector<std::uint8_t> SmallPng(int shade = 0) {
  cv::Mat image(7, 5, CV_8UC1, cv::Scalar(90));
  image.at<std::uint8_t>(3, 2) = static_cast<std::uint8_t>(shade);
  std::vector<std::uint8_t> png;
  cv::imencode(".png", image, png);
  return png;
}

// A report of every block there is, each holding `text`.
HtmlReport EveryBlock(const std::string& text) {
  HtmlReport report(text, text);
  report.KeyFigures({{text, text, text, text}});
  report.Callout(CalloutKind::kSynthetic, text, text);
  report.Section(text);
  report.Paragraph(text);
  report.Facts({{text, text}});
  report.List({text});
  report.Subsection(text);
  report.Subsection(text);
  report.Add(Table{.caption = text,
                   .columns = {{text, text}, {text}},
                   .rows = {{{text}, RowStyle::kGroup}, {{text, text}, RowStyle::kStrong}},
                   .notes = {text}});
  report.Section(text);
  report.Add(PictureRow{.caption = text,
                        .pictures = {{SmallPng(), text, text}, {SmallPng(1), text}},
                        .legend = {{text, text}}});
  report.Add({{.title = text,
               .x = {text, text},
               .y = {text, text},
               .series = {{text, {0.0, 1.0}, {1.0, 2.0}, SeriesStyle::kLine, {0.5, 1.5}, {1.5, 2.5}},
                          {text, {0.5}, {1.5}, SeriesStyle::kPoints}},
               .alt = text}},
             text);
  PolarAxes axes{1.0, 2.0, 7, {-0.1, -0.05, 0.0, 0.05, 0.1}};
  report.Add(FrameViewer{.caption = text,
                         .frames = {{.name = text,
                                     .figures = text,
                                     .axes = axes,
                                     .real = SmallPng(),
                                     .simulated = SmallPng(),
                                     .objects = SmallPng()}}});
  report.Code(text);
  report.Details(text, text);
  report.SetFooter(text);
  return report;
}

TEST(HtmlReportTest, EveryBlockIsWellFormed) {
  EXPECT_EQ(testing::HtmlFault(EveryBlock("plain").Html()), "");
}

TEST(HtmlReportTest, HostileTextStaysText) {
  const std::string html = EveryBlock(kHostile).Html();
  EXPECT_EQ(testing::HtmlFault(html), "");
  const std::size_t script = html.find("<script");
  EXPECT_THAT(html.substr(script + 1), Not(HasSubstr("<script")));  // the viewer's own, at the end
  EXPECT_THAT(html.substr(0, script), HasSubstr("<figure class=\"viewers\">"));
  EXPECT_THAT(html, HasSubstr("&lt;script&gt;"));
}

TEST(HtmlReportTest, ThePageAsksNothingOfTheNetwork) {
  const std::string html = EveryBlock("plain").Html();
  for (const char* request : {"http://", "https://", "src=\"//", "@import", "<link", "<script src", "<iframe",
                              "fetch(", "XMLHttpRequest", "import("}) {
    EXPECT_THAT(html, Not(HasSubstr(request)));
  }
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
}

// The hash that a browser computes, by which it runs this script and no other.
TEST(HtmlReportTest, TheScriptIsAllowedByItsHash) {
  HtmlReport plain("Title");
  EXPECT_THAT(plain.Html(), Not(HasSubstr("script-src")));
  plain.Add({{.title = "t", .series = {{"s", {0.0, 1.0}, {1.0, 2.0}}}}}, "chart");
  EXPECT_THAT(plain.Html(), HasSubstr("script-src"));
  const std::string html = EveryBlock("plain").Html();
  const std::size_t begin = html.find("<script>") + 8;
  const std::string script = html.substr(begin, html.find("</script>") - begin);
  std::array<std::uint8_t, 32> hash = {};
  ASSERT_EQ(EVP_Digest(script.data(), script.size(), hash.data(), nullptr, EVP_sha256(), nullptr), 1);
  EXPECT_THAT(html, HasSubstr("script-src 'sha256-" + Base64(hash) + "'"));
}

TEST(HtmlReportTest, HeadingsOfOneNameGetAnchorsOfTheirOwn) {
  HtmlReport report("Title");
  report.Section("Frame");
  report.Section("Frame");
  const std::string html = report.Html();
  EXPECT_THAT(html, HasSubstr("<h2 id=\"frame\">"));
  EXPECT_THAT(html, HasSubstr("<h2 id=\"frame-2\">"));
  EXPECT_THAT(html, HasSubstr("<a href=\"#frame-2\">"));
}

TEST(HtmlReportTest, TablesAndFiguresAreNumbered) {
  HtmlReport report("Title");
  for (int i = 0; i < 2; ++i) {
    report.Add(Table{.caption = "t", .columns = {{"a"}}, .rows = {{{"1"}}}});
    report.Add(PictureRow{.caption = "p", .pictures = {{SmallPng(i), "c"}}});
  }
  const std::string html = report.Html();
  EXPECT_THAT(html, HasSubstr("<b>Table 2.</b>"));
  EXPECT_THAT(html, HasSubstr("<b>Figure 2.</b>"));
}

TEST(HtmlReportTest, NoPictureIsShownTwice) {
  HtmlReport report("Title");
  report.Add(
      PictureRow{.caption = "Before.", .pictures = {{SmallPng(1), "Recorded"}, {SmallPng(2), "Simulated"}}});
  report.Add(
      PictureRow{.caption = "After.", .pictures = {{SmallPng(1), "Recorded"}, {SmallPng(3), "Simulated"}}});
  report.Add(
      PictureRow{.caption = "Again.", .pictures = {{SmallPng(2), "Simulated"}, {SmallPng(3), "Fitted"}}});
  const std::string html = report.Html();
  EXPECT_EQ(testing::PicturesOf(html).size(), 3U);
  EXPECT_EQ(testing::PictureFault(html), "");
  EXPECT_EQ(testing::HtmlFault(html), "");
  EXPECT_THAT(html, HasSubstr("After. Recorded: as in figure 1."));
  EXPECT_THAT(html, HasSubstr("<p>Again. Simulated: as in figure 1. Fitted: as in figure 2.</p>"));
  EXPECT_THAT(html, Not(HasSubstr("<b>Figure 3.</b>")));
  report.ParagraphOnce("What the colours mean.");
  report.ParagraphOnce("What the colours mean.");
  const std::string with = report.Html();
  EXPECT_EQ(with.find("What the colours mean."), with.rfind("What the colours mean."));
}

// As of a recording that is compared with itself.
TEST(HtmlReportTest, APictureThatEqualsAnotherOfItsFigureIsNamed) {
  HtmlReport report("Title");
  report.Add(
      PictureRow{.caption = "Frame 0.", .pictures = {{SmallPng(1), "Recorded"}, {SmallPng(1), "Simulated"}}});
  EXPECT_EQ(testing::PicturesOf(report.Html()).size(), 1U);
  EXPECT_THAT(report.Html(), HasSubstr("Frame 0. Simulated: the same picture as Recorded."));
}

TEST(HtmlReportTest, APictureOfOneColourIsDescribedAndNotShown) {
  HtmlReport report("Title");
  const std::vector<std::uint8_t> black = SmallPng(90);
  // A fan has a surrounding of its own.
  cv::Mat fan(7, 5, CV_8UC3, cv::Scalar(0, 0, 0));
  fan.row(0).setTo(cv::Scalar(255, 255, 255));
  std::vector<std::uint8_t> black_fan;
  cv::imencode(".png", fan, black_fan);
  EXPECT_TRUE(IsOneColour(black));
  EXPECT_TRUE(IsOneColour(black_fan));
  EXPECT_FALSE(IsOneColour(SmallPng()));
  report.Add(PictureRow{.caption = "Weights.", .pictures = {{black, "Frame 0"}, {black_fan, "Frame 4"}}});
  EXPECT_TRUE(testing::PicturesOf(report.Html()).empty());
  EXPECT_THAT(report.Html(), HasSubstr("<p>Weights. Frame 0: a single colour, not shown."));
}

TEST(HtmlReportTest, APictureCarriesItsSize) {
  HtmlReport report("Title");
  report.Add(PictureRow{.caption = "p", .pictures = {{SmallPng(), "c"}}});
  EXPECT_THAT(report.Html(), HasSubstr("width=\"5\" height=\"7\""));
}

TEST(HtmlReportTest, ARowThatDoesNotFitItsTableIsRefused) {
  HtmlReport report("Title");
  EXPECT_THROW(report.Add(Table{.caption = "t", .columns = {{"a"}, {"b"}}, .rows = {{{"1"}}}}),
               std::logic_error);
  EXPECT_THROW(report.Add(PictureRow{.caption = "p", .pictures = {{{1, 2, 3}, "c"}}}), std::logic_error);
}

TEST(HtmlReportTest, AChartCarriesItsValuesForThePointer) {
  const std::string html = LineChartHtml(
      {.title = "t",
       .x = {.label = "range", .unit = "m"},
       .series = {{"s", {0.0, 1.0}, {1.0, std::nan("")}, SeriesStyle::kLine, {0.5, 1.0}, {1.5, 1.0}}}});
  const std::size_t start = html.find("data-chart=\"") + 12;
  const std::string data = html.substr(start, html.find('"', start) - start);
  EXPECT_THAT(data, HasSubstr("&quot;text&quot;:&quot;range (m)&quot;"));
  EXPECT_THAT(data, HasSubstr("&quot;y&quot;:[1.0,null]"));
  EXPECT_THAT(data, HasSubstr("&quot;band&quot;:[[0.5,1.5],null]"));
}

TEST(HtmlReportTest, WritesItsFileOrSaysWhyNot) {
  const testing::TempDir dir;
  const HtmlReport report = EveryBlock("plain");
  report.Write(dir / "report.html");
  EXPECT_EQ(testing::ReadFile(dir / "report.html"), report.Html());
  EXPECT_THROW(report.Write(dir / "absent" / "report.html"), DataError);
}

const Table kTable = {.caption = "Error & bias_1",
                      .columns = {{"Frame"}, {"Error", "dB"}, {"What", {}, false}},
                      .rows = {{{"first half"}, RowStyle::kGroup},
                               {{"0", "−1.5", "a \"b\", c"}},
                               {{"mean", "–", "x|y"}, RowStyle::kStrong}},
                      .notes = {"100 % synthetic"}};

TEST(TableText, LatexTableEscapesTextAndAlignsNumbers) {
  EXPECT_EQ(LatexTable(kTable),
            "\\begin{table}\n\\centering\n\\caption{Error \\& bias\\_1}\n\\begin{tabular}{lrl}\n\\toprule\n"
            "Frame & Error (dB) & What \\\\\n\\midrule\n\\addlinespace\n"
            "\\multicolumn{3}{l}{\\emph{first half}} \\\\\n0 & $-$1.5 & a \"b\", c \\\\\n"
            "\\textbf{mean} & \\textbf{--} & \\textbf{x$|$y} \\\\\n\\bottomrule\n\\end{tabular}\n"
            "\\par\\footnotesize 100 \\% synthetic\n\\end{table}\n");
}

TEST(TableText, MarkdownTableEscapesTextAndAlignsNumbers) {
  EXPECT_EQ(
      MarkdownTable(kTable),
      "**Error & bias\\_1**\n\n| Frame | Error (dB) | What |\n|---|---:|---|\n| **first half** |  |  |\n"
      "| 0 | −1.5 | a \"b\", c |\n| **mean** | **–** | **x\\|y** |\n\n100 % synthetic\n\n");
}

TEST(TableText, CsvTableQuotesCellsAndLeavesAbsentValuesEmpty) {
  EXPECT_EQ(CsvTable(kTable),
            "Frame,Error (dB),What\r\nfirst half\r\n0,-1.5,\"a \"\"b\"\", c\"\r\nmean,,x|y\r\n");
}

TEST(PaperFiles, HoldEveryTableAndChart) {
  const testing::TempDir dir;
  HtmlReport report("Title", "of a test");
  report.Callout(CalloutKind::kSynthetic, "Both sides are synthetic", "No sonar recorded it.");
  report.KeyFigures({{"IoU", "0.5", {}, "95 %: 0.4 to 0.6"}});
  report.Section("Section");
  report.Add(kTable);
  report.Add(PictureRow{.caption = "p", .pictures = {{SmallPng(), "c"}}});
  const LineChart chart = {.title = "A < B", .series = {{"s", {0.0, 1.0}, {1.0, 2.0}}}};
  report.Add({chart, chart}, "charts");
  Table table = kTable;
  table.rows.resize(21, table.rows.back());
  report.Add(table);
  WritePaperFiles(report, dir / "");
  EXPECT_EQ(testing::ReadFile(dir / "tables" / "table_1.tex"), LatexTable(kTable));
  EXPECT_EQ(testing::ReadFile(dir / "tables" / "table_2.csv"), CsvTable(table));
  const std::string svg = testing::ReadFile(dir / "figures" / "figure_2_2.svg");
  EXPECT_EQ(svg, LineChartSvg(chart));
  EXPECT_EQ(testing::HtmlFault("<!DOCTYPE html>" + svg), "");
  EXPECT_THAT(svg, HasSubstr("A &lt; B"));
  const std::string summary = testing::ReadFile(dir / "summary.md");
  EXPECT_THAT(summary, HasSubstr("> Both sides are synthetic. No sonar recorded it."));
  EXPECT_THAT(summary, HasSubstr("| IoU | 0.5 | 95 %: 0.4 to 0.6 |"));
  EXPECT_THAT(summary, HasSubstr(MarkdownTable(kTable)));
  EXPECT_THAT(summary, Not(HasSubstr(MarkdownTable(table))));
}

TEST(HtmlTextTest, Base64OfEveryRemainder) {
  const auto encode = [](std::string_view text) {
    return Base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
}

TEST(HtmlTextTest, NumbersCarryATrueMinusAndNoNegativeZero) {
  EXPECT_EQ(FormatNumber(-1.25, 1), "\u22121.2");
  EXPECT_EQ(FormatNumber(-0.001, 2), "0.00");
  EXPECT_EQ(FormatNumber(std::nan(""), 2), "\u2013");
  EXPECT_EQ(FormatNumber(std::nullopt, 2), "\u2013");
}

TEST(HtmlTextTest, OnlyValidUtf8Passes) {
  EXPECT_EQ(EscapeHtml("20 \u00B0C"), "20 \u00B0C");
  EXPECT_EQ(EscapeHtml("\xC0\xAF"), "\uFFFD\uFFFD");            // overlong
  EXPECT_EQ(EscapeHtml("\xED\xA0\x80"), "\uFFFD\uFFFD\uFFFD");  // a surrogate
  EXPECT_EQ(EscapeHtml("\xE2\x82"), "\uFFFD\uFFFD");            // cut short
}

TEST(LineChartTest, ValuesThatAreNotFiniteBreakTheLine) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string html = LineChartHtml(
      {.title = "t", .x = {"x", ""}, .y = {"y", ""}, .series = {{"s", {0, 1, 2, 3, 4}, {1, 2, nan, 2, 1}}}});
  const std::size_t path = html.find("<path class=\"line c0\"");
  ASSERT_NE(path, std::string::npos);
  const std::string drawn = html.substr(path, html.find("/>", path) - path);
  EXPECT_EQ(std::count(drawn.begin(), drawn.end(), 'M'), 2) << drawn;
  EXPECT_THAT(html, Not(HasSubstr("nan")));
}

// Every outline of a chart's band: pairs of x and y in units of the drawing.
std::vector<std::vector<std::pair<double, double>>> BandOutlines(const std::string& html) {
  std::vector<std::vector<std::pair<double, double>>> outlines;
  const std::size_t path = html.find("<path class=\"band c0\" d=\"M");
  if (path == std::string::npos) return outlines;
  const std::size_t start = html.find('M', path);
  std::istringstream drawn(html.substr(start, html.find('"', start) - start));
  char command = 0;
  while (drawn >> command) {
    if (command == 'Z') continue;
    if (command == 'M') outlines.emplace_back();
    double x = 0.0;
    double y = 0.0;
    drawn >> x >> y;
    outlines.back().emplace_back(x, y);
  }
  return outlines;
}

TEST(LineChartTest, ABandBreaksWhereItsCurveHasNoValue) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  // The edges of the gap are finite: they say nothing where there is no curve, far away as they are.
  const ChartSeries series{.name = "s",
                           .x = {0, 1, 2, 3, 4, 5},
                           .y = {10, 20, nan, nan, 20, 10},
                           .low = {9, 19, -500, -500, 19, 9},
                           .high = {11, 21, 500, 500, 21, 11}};
  for (const SeriesStyle style : {SeriesStyle::kLine, SeriesStyle::kBand}) {
    LineChart chart{.title = "t", .x = {"x", ""}, .y = {"y", ""}, .series = {series}};
    chart.series[0].style = style;
    const std::string html = LineChartHtml(chart);
    const auto outlines = BandOutlines(html);
    ASSERT_EQ(outlines.size(), 2U) << html;
    for (const auto& outline : outlines) EXPECT_EQ(outline.size(), 4U) << "there and back over two values";
    const double left = outlines[0][0].first;
    const double width = outlines[1][1].first - left;
    for (const auto& [x, y] : outlines[0]) EXPECT_LE(x, left + 0.21 * width);
    for (const auto& [x, y] : outlines[1]) EXPECT_GE(x, left + 0.79 * width);
    EXPECT_THAT(html, Not(HasSubstr("500"))) << "the axis is that of what is drawn";
    EXPECT_EQ(html.find("<path class=\"line") != std::string::npos, style == SeriesStyle::kLine);
  }
}

TEST(LineChartTest, EmptyAndConstantSeriesStillHaveAxes) {
  for (const ChartSeries& series : {ChartSeries{"none", {}, {}}, ChartSeries{"one", {3.0}, {0.0}},
                                    ChartSeries{"level", {1.0, 2.0}, {-5.0, -5.0}}}) {
    const std::string html =
        LineChartHtml({.title = "t", .x = {"x", ""}, .y = {"y", ""}, .series = {series}});
    EXPECT_EQ(testing::HtmlFault("<!DOCTYPE html>" + html), "") << html;
    EXPECT_THAT(html, HasSubstr("class=\"tick\""));
    EXPECT_THAT(html, Not(HasSubstr("inf")));
  }
}

TEST(LineChartTest, AValueWithoutNeighbourIsDrawnAsAPoint) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  LineChart chart{.title = "t", .series = {{"s", {0, 1, 2, 3, 4, 5}, {1, nan, 2, 1, nan, 2}}}};
  const auto points_of = [&](SeriesStyle style) {
    chart.series[0].style = style;
    const std::string svg = LineChartHtml(chart);
    int points = 0;
    for (std::size_t at = 0; (at = svg.find("<circle", at)) != std::string::npos; ++at) ++points;
    return points;
  };
  EXPECT_EQ(points_of(SeriesStyle::kLine), 2);
  EXPECT_EQ(points_of(SeriesStyle::kDashed), 2);
  EXPECT_EQ(points_of(SeriesStyle::kBand), 0);
}

TEST(LineChartTest, AConstantMovesNoEndOfAnAxisThatIsGiven) {
  LineChart chart{.title = "t", .series = {{"s", {0.0, 1.0}, {0.0, 0.0}}}};
  const auto html_of = [&](std::optional<double> min, std::optional<double> max) {
    chart.y = {.label = "y", .min = min, .max = max};
    return LineChartHtml(chart);
  };
  constexpr const char* kAxis = "&quot;y&quot;:{&quot;min&quot;:";
  EXPECT_THAT(html_of({}, {}), HasSubstr(std::string(kAxis) + "-1.0,&quot;max&quot;:1.0"));
  EXPECT_THAT(html_of(0.0, {}), HasSubstr(std::string(kAxis) + "0.0,&quot;max&quot;:1.0"));
  EXPECT_THAT(html_of({}, 0.0), HasSubstr(std::string(kAxis) + "-1.0,&quot;max&quot;:0.0"));
}

TEST(LineChartTest, ASeriesOfUnequalLengthsIsRefused) {
  EXPECT_THROW(LineChartHtml({.title = "t", .series = {{"s", {0, 1}, {1}}}}), std::logic_error);
  EXPECT_THROW(LineChartHtml({.title = "t", .series = {{"s", {0}, {1}, SeriesStyle::kLine, {0}, {}}}}),
               std::logic_error);
}

}  // namespace
}  // namespace sonarcal::report
