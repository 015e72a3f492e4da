#include "apps/report/against_section.h"

#include <fmt/format.h>

#include <utility>

#include "apps/report/html_text.h"
#include "metrics/figures.h"

namespace sonarcal {
namespace {

constexpr int kDecimals = 3;
constexpr const char* kNoValue = "–";

const char* VerdictText(ChangeVerdict verdict) {
  switch (verdict) {
    case ChangeVerdict::kBetter:
      return "better";
    case ChangeVerdict::kWorse:
      return "worse";
    case ChangeVerdict::kSame:
      return "the same";
    case ChangeVerdict::kNotTold:
      break;
  }
  return "within the noise";
}

}  // namespace

void AddAgainst(HtmlReport& report, const Against& against) {
  Table table{.caption = fmt::format("Against {}", against.earlier),
              .columns = {{"Figure"}, {"View"}, {"Before"}, {"Now"}, {"Verdict"}, {"Way to the floor", "%"}},
              .rows = {},
              .notes = {}};
  table.notes.push_back(
      against.common_frames > 0
          ? fmt::format(
                "Means over frames. A change counts where the 95 % interval of the difference over the "
                "{} frames of both does not hold 0.",
                against.common_frames)
          : "Means over frames. Too few frames stand in both: a change counts where the two 95 % intervals "
            "lie "
            "apart.");
  table.notes.push_back(fmt::format(
      "Of all {} figures {} got better and {} worse; one in twenty does by chance. In strong print the ones "
      "that are looked at first.",
      against.figures.size(), against.Count(ChangeVerdict::kBetter, false),
      against.Count(ChangeVerdict::kWorse, false)));
  for (const std::string& note : against.notes) table.notes.push_back("Note: " + note + ".");
  for (const FigureChange& change : against.figures) {
    const bool told = change.verdict == ChangeVerdict::kBetter || change.verdict == ChangeVerdict::kWorse;
    if (!change.headline && !told) continue;
    table.rows.push_back({{Figures()[FigureIndex(change.path)].label, change.fan ? "fan" : "polar",
                           FormatNumber(change.earlier, kDecimals), FormatNumber(change.now, kDecimals),
                           VerdictText(change.verdict),
                           change.explained ? fmt::format("{:.0f}", 100.0 * *change.explained) : kNoValue},
                          change.headline ? RowStyle::kStrong : RowStyle::kPlain});
  }
  report.Add(table);
}

}  // namespace sonarcal
