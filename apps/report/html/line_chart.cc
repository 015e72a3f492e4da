#include "apps/report/html/line_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>

#include <nlohmann/json.hpp>

#include "apps/report/html/axis_ticks.h"
#include "apps/report/html/html_text.h"
#include "core/types/error.h"

namespace sonarcal::report {
namespace {

using Json = nlohmann::ordered_json;

// Sizes in units of the drawing, which the page scales. Text has these units too, and is larger on a phone
// (report.css). The margins leave room for that.
constexpr double kWidth = 480.0;
constexpr double kHeight = 300.0;
constexpr double kLeft = 52.0;
constexpr double kRight = 14.0;
constexpr double kTop = 30.0;
constexpr double kBottom = 50.0;
constexpr double kPlotWidth = kWidth - kLeft - kRight;
constexpr double kPlotHeight = kHeight - kTop - kBottom;
constexpr int kColours = 6;

struct Scale {
  double min = 0.0;
  double max = 1.0;
  double step = 0.2;
  int decimals = 1;

  double Fraction(double value) const { return (value - min) / (max - min); }
  bool Contains(double value) const { return value >= min && value <= max; }  // false for NaN
};

Scale MakeScale(const ChartAxis& axis, double data_min, double data_max, int tick_count) {
  if (!(data_min <= data_max)) {  // no finite value
    data_min = 0.0;
    data_max = 1.0;
  }
  double min = axis.min.value_or(data_min);
  double max = axis.max.value_or(data_max);
  if (!(max - min > 1e-12 * std::max(std::abs(min), std::abs(max)))) {  // a constant
    SONARCAL_CHECK(!axis.min || !axis.max, "axis '{}' from {} to {}", axis.label, min, max);
    const double at = axis.max ? max : min;
    const double margin = at == 0.0 ? 1.0 : 0.5 * std::abs(at);
    if (!axis.min) min = at - margin;
    if (!axis.max) max = at + margin;
  }
  Scale scale;
  scale.step = NiceStep(max - min, tick_count);
  scale.min = axis.min ? min : std::floor(min / scale.step + 1e-9) * scale.step;
  scale.max = axis.max ? max : std::ceil(max / scale.step - 1e-9) * scale.step;
  scale.decimals = DecimalsOf(scale.step);
  return scale;
}

struct Scales {
  Scale x;
  Scale y;
};

// A band exists only where its curve has a value.
bool HasBand(const ChartSeries& series, std::size_t i) {
  return !series.low.empty() && std::isfinite(series.x[i]) && std::isfinite(series.y[i]) &&
         std::isfinite(series.low[i]) && std::isfinite(series.high[i]);
}

Scales FitScales(const LineChart& chart) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double bounds[2][2] = {{kInfinity, -kInfinity}, {kInfinity, -kInfinity}};
  const auto include = [&](int axis, double value) {
    if (!std::isfinite(value)) return;
    bounds[axis][0] = std::min(bounds[axis][0], value);
    bounds[axis][1] = std::max(bounds[axis][1], value);
  };
  for (const ChartSeries& series : chart.series) {
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      include(0, series.x[i]);
      include(1, series.y[i]);
      if (!HasBand(series, i)) continue;
      include(1, series.low[i]);
      include(1, series.high[i]);
    }
  }
  return {MakeScale(chart.x, bounds[0][0], bounds[0][1], 6),
          MakeScale(chart.y, bounds[1][0], bounds[1][1], 5)};
}

// Values without a neighbour. They make no line, so they are drawn as points.
ChartSeries Isolated(const ChartSeries& series) {
  const auto has_value = [&](std::size_t i) {
    return i < series.x.size() && std::isfinite(series.x[i]) && std::isfinite(series.y[i]);
  };
  ChartSeries isolated{.name = series.name, .x = {}, .y = {}};
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!has_value(i) || (i > 0 && has_value(i - 1)) || has_value(i + 1)) continue;
    isolated.x.push_back(series.x[i]);
    isolated.y.push_back(series.y[i]);
  }
  return isolated;
}

std::string AxisText(const ChartAxis& axis) {
  return axis.unit.empty() ? axis.label : axis.label + " (" + axis.unit + ")";
}

class Drawing {
 public:
  explicit Drawing(const Scales& scales) : scales_(scales) {}

  void Axes(const LineChart& chart) {
    Append("<g class=\"ticks\">");
    for (const double tick : TicksWithin(scales_.y.min, scales_.y.max, scales_.y.step)) {
      const double y = kTop + PlotY(tick);
      Append("<line class=\"grid\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>", kLeft, y,
             kLeft + kPlotWidth, y);
      Append("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\" dy=\"0.35em\">{}</text>",
             kLeft - 7.0, y, TickText(tick, scales_.y));
    }
    const double base = kTop + kPlotHeight;
    for (const double tick : TicksWithin(scales_.x.min, scales_.x.max, scales_.x.step)) {
      const double x = kLeft + PlotX(tick);
      Append("<line class=\"mark\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>", x, base, x,
             base + 5.0);
      Append("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>", x,
             base + 19.0, TickText(tick, scales_.x));
    }
    Append("</g>");
    Append("<line class=\"axis\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>", kLeft, base,
           kLeft + kPlotWidth, base);
    Append("<text class=\"name\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", kLeft + kPlotWidth,
           kHeight - 7.0, EscapeHtml(AxisText(chart.x)));
    Append("<text class=\"name\" x=\"4\" y=\"15\">{}</text>", EscapeHtml(AxisText(chart.y)));
  }

  // An inner <svg> clips to the range of the axes, without an id.
  void OpenPlot() {
    Append("<svg x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" overflow=\"hidden\">", kLeft,
           kTop, kPlotWidth, kPlotHeight);
  }
  void ClosePlot() { Append("</svg>"); }

  // Draws one outline per run of values: forward along the upper edge, back along the lower one.
  void Band(const ChartSeries& series, int colour) {
    std::string path;
    for (std::size_t first = 0; first < series.x.size(); ++first) {
      std::size_t end = first;
      while (end < series.x.size() && HasBand(series, end)) ++end;
      if (end == first) continue;
      for (std::size_t i = first; i < end; ++i)
        AppendPoint(path, i == first ? 'M' : 'L', series.x[i], series.high[i]);
      for (std::size_t i = end; i-- > first;) AppendPoint(path, 'L', series.x[i], series.low[i]);
      path += 'Z';
      first = end;
    }
    if (!path.empty()) Append("<path class=\"band c{}\" d=\"{}\"/>", colour, path);
  }

  void Line(const ChartSeries& series, int colour) {
    std::string path;
    bool pen_down = false;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (!std::isfinite(series.x[i]) || !std::isfinite(series.y[i])) {
        pen_down = false;
        continue;
      }
      AppendPoint(path, pen_down ? 'L' : 'M', series.x[i], series.y[i]);
      pen_down = true;
    }
    const char* dash = series.style == SeriesStyle::kDashed ? " dashed" : "";
    Append("<path class=\"line{} c{}\" d=\"{}\"/>", dash, colour, path);
  }

  // Outside the clipped plot, so that a point on an axis stays round.
  void Points(const ChartSeries& series, int colour) {
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (!scales_.x.Contains(series.x[i]) || !scales_.y.Contains(series.y[i])) continue;
      Append("<circle class=\"point c{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.6\"/>", colour,
             kLeft + PlotX(series.x[i]), kTop + PlotY(series.y[i]));
    }
  }

  const std::string& svg() const { return svg_; }

 private:
  template <typename... Args>
  void Append(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(svg_), format, std::forward<Args>(args)...);
  }

  static std::string TickText(double tick, const Scale& scale) { return FormatNumber(tick, scale.decimals); }
  double PlotX(double value) const { return kPlotWidth * scales_.x.Fraction(value); }
  double PlotY(double value) const { return kPlotHeight * (1.0 - scales_.y.Fraction(value)); }
  void AppendPoint(std::string& path, char command, double x, double y) const {
    fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", command, PlotX(x), PlotY(y));
  }

  Scales scales_;
  std::string svg_;
};

// Colour of a series: its own, or that of its index.
int ColourOf(const ChartSeries& series, std::size_t place) {
  return series.colour >= 0 ? series.colour % kColours : static_cast<int>(place % kColours);
}

// Sample of a series for the legend, 26 x 12.
std::string Swatch(const ChartSeries& series, int colour) {
  std::string swatch;
  if (!series.low.empty()) swatch += fmt::format("<path class=\"band c{}\" d=\"M0 1H26V11H0Z\"/>", colour);
  if (series.style == SeriesStyle::kBand) return swatch;
  if (series.style == SeriesStyle::kPoints) {
    return swatch + fmt::format("<circle class=\"point c{}\" cx=\"13\" cy=\"6\" r=\"4\"/>", colour);
  }
  return swatch + fmt::format("<path class=\"line{} c{}\" d=\"M0 6H26\"/>",
                              series.style == SeriesStyle::kDashed ? " dashed" : "", colour);
}

std::string LegendHtml(const LineChart& chart) {
  std::string html = "<ul class=\"legend\">";
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    html += fmt::format(
        "<li><svg viewBox=\"0 0 26 12\" width=\"26\" height=\"12\" aria-hidden=\"true\">{}</svg>{}</li>",
        Swatch(chart.series[i], ColourOf(chart.series[i], i)), EscapeHtml(chart.series[i].name));
  }
  return html + "</ul>";
}

// Five digits; null if the value is not finite.
Json JsonOf(double value) {
  return std::isfinite(value) ? Json(std::stod(fmt::format("{:.5g}", value))) : Json(nullptr);
}

Json JsonOf(const std::vector<double>& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(JsonOf(value));
  return json;
}

// Axes and values for chart.js.
std::string DataOf(const LineChart& chart) {
  const Scales scales = FitScales(chart);
  const auto axis = [](const Scale& scale, const ChartAxis& of) {
    return Json{{"min", scale.min}, {"max", scale.max}, {"text", AxisText(of)}};
  };
  Json series = Json::array();
  for (const ChartSeries& of : chart.series) {
    series.push_back({{"name", of.name}, {"x", JsonOf(of.x)}, {"y", JsonOf(of.y)}});
    if (of.low.empty()) continue;
    Json& band = series.back()["band"] = Json::array();
    for (std::size_t i = 0; i < of.low.size(); ++i)
      band.push_back(HasBand(of, i) ? Json{JsonOf(of.low[i]), JsonOf(of.high[i])} : Json(nullptr));
  }
  const Json data = {{"box", {kLeft, kTop, kPlotWidth, kPlotHeight}},
                     {"x", axis(scales.x, chart.x)},
                     {"y", axis(scales.y, chart.y)},
                     {"series", series}};
  return data.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void Check(const ChartSeries& series) {
  SONARCAL_CHECK(series.x.size() == series.y.size(), "series {}: {} x, {} y", series.name, series.x.size(),
                 series.y.size());
  SONARCAL_CHECK(
      series.low.size() == series.high.size() && (series.low.empty() || series.low.size() == series.x.size()),
      "series {}: {} x, band of {} and {}", series.name, series.x.size(), series.low.size(),
      series.high.size());
}

std::string PlotSvg(const LineChart& chart) {
  for (const ChartSeries& series : chart.series) Check(series);
  Drawing drawing(FitScales(chart));
  drawing.Axes(chart);
  drawing.OpenPlot();
  // Draws bands below all lines, so that none hides a line.
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    if (!chart.series[i].low.empty()) drawing.Band(chart.series[i], ColourOf(chart.series[i], i));
  }
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const ChartSeries& series = chart.series[i];
    const bool is_line = series.style == SeriesStyle::kLine || series.style == SeriesStyle::kDashed;
    if (is_line) drawing.Line(series, ColourOf(series, i));
  }
  drawing.ClosePlot();
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const ChartSeries& series = chart.series[i];
    if (series.style == SeriesStyle::kPoints)
      drawing.Points(series, ColourOf(series, i));
    else if (series.style != SeriesStyle::kBand)
      drawing.Points(Isolated(series), ColourOf(series, i));
  }
  return drawing.svg();
}

// Light colours as in report.css.
constexpr std::string_view kFileStyle =
    "text{font:12px sans-serif;fill:#56646e}.name,.title{fill:#1b2329}.title{font-weight:bold;font-size:14px}"
    ".grid{stroke:#d9dfe3}.axis,.mark{stroke:#8b98a2}.line{fill:none;stroke-width:2;stroke-linejoin:round}"
    ".dashed{stroke-dasharray:6 5}.band{fill-opacity:0.17;stroke:none}.point{stroke:#ffffff}";
constexpr std::array<std::string_view, kColours> kFileColours = {"#0868a8", "#bd4f00", "#20754a",
                                                                 "#7a49a5", "#a8326c", "#5b6670"};

}  // namespace

std::string LineChartHtml(const LineChart& chart) {
  const std::string plot = PlotSvg(chart);
  const std::string& alt = chart.alt.empty() ? chart.title : chart.alt;
  return fmt::format(
      "<figure class=\"chart\" data-chart=\"{}\"><div class=\"chart-title\">{}</div>"
      "<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">{}</svg>{}</figure>\n",
      EscapeHtml(DataOf(chart)), EscapeHtml(chart.title), kWidth, kHeight, EscapeHtml(alt), plot,
      LegendHtml(chart));
}

std::string LineChartSvg(const LineChart& chart) {
  constexpr double kTitleHeight = 28.0;
  constexpr double kLineHeight = 18.0;
  const double height = kTitleHeight + kHeight + kLineHeight * static_cast<double>(chart.series.size()) + 6.0;
  std::string style(kFileStyle);
  for (std::size_t i = 0; i < kFileColours.size(); ++i) {
    style += fmt::format(".line.c{0}{{stroke:{1}}}.band.c{0},.point.c{0}{{fill:{1}}}", i, kFileColours[i]);
  }
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\">"
      "<style>{2}</style><rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>"
      "<text class=\"title\" x=\"4\" y=\"18\">{3}</text><g transform=\"translate(0 {4})\">{5}</g>",
      kWidth, height, style, EscapeHtml(chart.title), kTitleHeight, PlotSvg(chart));
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const double y = kTitleHeight + kHeight + kLineHeight * static_cast<double>(i);
    svg +=
        fmt::format("<g transform=\"translate({} {})\">{}<text x=\"34\" y=\"10\">{}</text></g>", kLeft, y,
                    Swatch(chart.series[i], ColourOf(chart.series[i], i)), EscapeHtml(chart.series[i].name));
  }
  return svg + "</svg>\n";
}

}  // namespace sonarcal::report
