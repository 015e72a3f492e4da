// A waterfall as inline SVG, read from top to bottom: one bar a step, as long as what is left after it, with
// what the step took away (or added) set apart by its colour, and a word of judgement at the end.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace sonarcal::report {

enum class WaterfallMood { kStart, kBetter, kSame, kWorse };

struct WaterfallRow {
  std::string label;
  double value = 0.0;  // what is left after this step, 0 or more
  WaterfallMood mood = WaterfallMood::kStart;
  std::string word;  // "worth it"
};

struct Waterfall {
  std::string title;
  std::string unit = {};
  int decimals = 3;
  std::vector<WaterfallRow> rows = {};
  std::optional<double> floor = {};  // that no model could be below; a line
  std::string floor_label = {};
  std::string alt = {};  // what the picture shows, for those who can't see it
};

// A <figure class="chart"> whose colours are those of report.css.
std::string WaterfallHtml(const Waterfall& waterfall);

// The same drawing as an SVG file of its own, for a paper: light, with its title.
std::string WaterfallSvg(const Waterfall& waterfall);

}  // namespace sonarcal::report
