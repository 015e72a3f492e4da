#include "apps/report/html/waterfall.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "apps/report/html/html_text.h"
#include "core/types/error.h"

namespace sonarcal::report {
namespace {

// Sizes in units of the drawing, which the page scales.
constexpr double kWaterfallWidth = 720.0;
constexpr double kWaterfallLeft = 190.0;   // end of the labels
constexpr double kWaterfallRight = 210.0;  // start of the words, from the right
constexpr double kRow = 34.0;
constexpr double kBar = 20.0;
constexpr double kWaterfallTop = 8.0;
constexpr double kWaterfallBottom = 26.0;
constexpr double kBars = kWaterfallWidth - kWaterfallLeft - kWaterfallRight;

double HeightOf(const Waterfall& waterfall) {
  return kWaterfallTop + kRow * static_cast<double>(waterfall.rows.size()) + kWaterfallBottom;
}

std::string_view ClassOf(WaterfallMood mood) {
  constexpr std::array<std::string_view, 4> kClasses = {"plain", "better", "same", "worse"};
  return kClasses[static_cast<std::size_t>(mood)];
}

std::string DrawnWaterfall(const Waterfall& waterfall) {
  double most = waterfall.floor.value_or(0.0);
  for (const WaterfallRow& row : waterfall.rows) most = std::max(most, row.value);
  const double scale = most > 0.0 ? kBars / most : 0.0;
  std::string svg;
  const auto bar = [&](std::string_view of, double from, double to, double y) {
    if (!(to > from)) return;
    svg += fmt::format(R"(<rect class="bar {}" x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{}"/>)", of,
                       kWaterfallLeft + scale * from, y, scale * (to - from), kBar);
  };
  for (std::size_t i = 0; i < waterfall.rows.size(); ++i) {
    const WaterfallRow& row = waterfall.rows[i];
    const double y = kWaterfallTop + kRow * static_cast<double>(i);
    const double before = i == 0 ? row.value : waterfall.rows[i - 1].value;
    // Draws the rest, and the part that the step removed or added.
    bar("plain", 0.0, std::min(row.value, before), y);
    bar(row.value <= before ? "taken" : "worse", std::min(row.value, before), std::max(row.value, before), y);
    const double middle = y + 0.5 * kBar;
    svg += fmt::format(R"(<text class="name" x="{:.1f}" y="{:.1f}" text-anchor="end" dy="0.35em">{}</text>)",
                       kWaterfallLeft - 10.0, middle, EscapeHtml(row.label));
    svg += fmt::format(R"(<text class="word {}" x="{:.1f}" y="{:.1f}" dy="0.35em">{}  {}</text>)",
                       ClassOf(row.mood), kWaterfallLeft + kBars + 10.0, middle,
                       FormatNumber(row.value, waterfall.decimals), EscapeHtml(row.word));
  }
  if (waterfall.floor) {
    const double x = kWaterfallLeft + scale * *waterfall.floor;
    const double bottom = HeightOf(waterfall) - kWaterfallBottom;
    svg += fmt::format(R"(<line class="floor" x1="{0:.1f}" y1="{1:.1f}" x2="{0:.1f}" y2="{2:.1f}"/>)", x,
                       kWaterfallTop - 6.0, bottom);
    svg += fmt::format(R"(<text class="tick" x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)", x,
                       bottom + 16.0,
                       EscapeHtml(fmt::format("{} {}", waterfall.floor_label,
                                              FormatNumber(*waterfall.floor, waterfall.decimals))));
  }
  return svg;
}

// Light colours as in report.css.
constexpr std::string_view kWaterfallFileStyle =
    "text{font:12px sans-serif;fill:#56646e}.name,.title{fill:#1b2329}.title{font-weight:bold;font-size:14px}"
    ".bar.plain{fill:#0868a8}.bar.taken{fill:#20754a;fill-opacity:0.3}.bar.worse{fill:#b3261e}"
    ".word.better{fill:#20754a;font-weight:bold}.word.worse{fill:#b3261e}"
    ".floor{stroke:#1b2329;stroke-width:2;stroke-dasharray:5 4}";

}  // namespace

std::string WaterfallHtml(const Waterfall& waterfall) {
  SONARCAL_CHECK(!waterfall.rows.empty(), "a waterfall without steps: {}", waterfall.title);
  const std::string& alt = waterfall.alt.empty() ? waterfall.title : waterfall.alt;
  const std::string unit = waterfall.unit.empty() ? std::string() : fmt::format(" ({})", waterfall.unit);
  return fmt::format(
      "<figure class=\"chart waterfall\"><div class=\"chart-title\">{}</div>"
      "<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">{}</svg></figure>\n",
      EscapeHtml(waterfall.title + unit), kWaterfallWidth, HeightOf(waterfall), EscapeHtml(alt),
      DrawnWaterfall(waterfall));
}

std::string WaterfallSvg(const Waterfall& waterfall) {
  constexpr double kTitleHeight = 28.0;
  const double height = kTitleHeight + HeightOf(waterfall);
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\">"
      "<style>{2}</style><rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>"
      "<text class=\"title\" x=\"4\" y=\"18\">{3}</text><g transform=\"translate(0 {4})\">{5}</g></svg>\n",
      kWaterfallWidth, height, kWaterfallFileStyle, EscapeHtml(waterfall.title), kTitleHeight,
      DrawnWaterfall(waterfall));
}

}  // namespace sonarcal::report
