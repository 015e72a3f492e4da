// A line chart as inline SVG: lines, dashed lines and points over two linear axes, with an optional band
// about each series. Colours and line widths come from report.css, so that a chart follows the light or dark
// setting. chart.js adds values under the pointer and zoom.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace sonarcal::report {

struct ChartAxis {
  std::string label;
  std::string unit = {};           // empty for a pure number
  std::optional<double> min = {};  // default: from the data, rounded outwards to a tick
  std::optional<double> max = {};
};

enum class SeriesStyle { kLine, kDashed, kPoints, kBand };  // kBand: the band alone

struct ChartSeries {
  std::string name;
  std::vector<double> x;
  // A value that is not finite interrupts line and band. A value without a neighbour is drawn as a point.
  std::vector<double> y;
  SeriesStyle style = SeriesStyle::kLine;
  std::vector<double> low = {};  // band, one value per x; empty: none
  std::vector<double> high = {};
  int colour = -1;  // 0..5; -1: by the index of the series. Allows "before" and "after" to share a colour
};

struct LineChart {
  std::string title;
  ChartAxis x = {};
  ChartAxis y = {};
  std::vector<ChartSeries> series = {};
  std::string alt = {};  // description for screen readers
};

// Returns a <figure class="chart"> with title, drawing and legend. Checks that x, y and band have equal
// lengths.
std::string LineChartHtml(const LineChart& chart);

// Returns the drawing as a separate SVG file for a paper: light, with title and legend in the picture.
std::string LineChartSvg(const LineChart& chart);

}  // namespace sonarcal::report
