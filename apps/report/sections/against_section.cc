#include "apps/report/sections/against_section.h"

#include <fmt/format.h>

#include <utility>

#include "apps/report/html/html_text.h"
#include "apps/report/sections/figure_words.h"
#include "metrics/figures.h"

namespace sonarcal::report {
namespace {

constexpr const char* kNotExplained = "–";

const char* VerdictText(const metrics::FigureChange& change) {
  switch (change.verdict) {
    case metrics::ChangeVerdict::kBetter:
      return "better";
    case metrics::ChangeVerdict::kWorse:
      return "worse";
    case metrics::ChangeVerdict::kSame:
      return "the same";
    case metrics::ChangeVerdict::kNotTold:
      break;
  }
  return change.is_judged ? "within the noise" : "cannot be told";
}

}  // namespace

void AddAgainst(HtmlReport& report, const metrics::Against& against) {
  Table table{.caption = fmt::format("Against {}", against.earlier),
              .columns = {{"Figure"}, {"View"}, {"Before"}, {"Now"}, {"Verdict"}, {"Way to the floor", "%"}},
              .rows = {},
              .notes = {}};
  table.notes.push_back(against.common_frames > 0
                            ? fmt::format("Means over frames. A change is significant if the 95 % interval "
                                          "of the difference over the {} common frames does not contain 0.",
                                          against.common_frames)
                            : "Means over frames. Too few common frames: a change is significant if the two "
                              "95 % intervals do not overlap.");
  table.notes.push_back(
      fmt::format("Of all {} figures, {} got better and {} worse; one in twenty does so by chance. Headline "
                  "figures are bold.",
                  against.figures.size(), against.Count(metrics::ChangeVerdict::kBetter, false),
                  against.Count(metrics::ChangeVerdict::kWorse, false)));
  for (const std::string& note : against.notes) table.notes.push_back("Note: " + note + ".");
  for (const metrics::FigureChange& change : against.figures) {
    const bool told =
        change.verdict == metrics::ChangeVerdict::kBetter || change.verdict == metrics::ChangeVerdict::kWorse;
    if (!change.headline && !told) continue;
    table.rows.push_back(
        {{metrics::Figures()[metrics::FigureIndex(change.path)].label, change.fan ? "fan" : "polar",
          FigureText(change.earlier), FigureText(change.now), VerdictText(change),
          change.explained ? fmt::format("{:.0f}", 100.0 * *change.explained) : kNotExplained},
         change.headline ? RowStyle::kStrong : RowStyle::kPlain});
  }
  report.Add(table);
}

}  // namespace sonarcal::report
