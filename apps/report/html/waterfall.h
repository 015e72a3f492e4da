// A waterfall chart as inline SVG, from top to bottom: one bar per step with the length of its value. The
// part that the step removed or added has another colour. A verdict is at the end of the bar.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace sonarcal::report {

enum class WaterfallMood { kStart, kBetter, kSame, kWorse };

struct WaterfallRow {
  std::string label;
  double value = 0.0;  // value after this step, 0 or more
  WaterfallMood mood = WaterfallMood::kStart;
  std::string word;  // verdict, such as "significant"
};

struct Waterfall {
  std::string title;
  std::string unit = {};
  int decimals = 3;
  std::vector<WaterfallRow> rows = {};
  std::optional<double> floor = {};  // lowest value that a model can reach; a line
  std::string floor_label = {};
  std::string alt = {};  // description for screen readers
};

// Returns a <figure class="chart"> with the colours of report.css.
std::string WaterfallHtml(const Waterfall& waterfall);

// Returns the drawing as a separate SVG file for a paper: light, with its title.
std::string WaterfallSvg(const Waterfall& waterfall);

}  // namespace sonarcal::report
