#include "apps/report/sections/against_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sonarcal::report {
namespace {

std::string VerdictWithAmount(const metrics::FigureChange& change) {
  const std::string by = fmt::format(" by {:.4f}", std::abs(change.worsening));
  // Interval of the amount. The interval of the worsening is reversed if the figure got better.
  const auto interval = [&](double sign) {
    if (!change.worsening_ci) return std::string();
    const metrics::Interval& ci = *change.worsening_ci;
    const double lo = sign > 0.0 ? ci.lo : -ci.hi;
    const double hi = sign > 0.0 ? ci.hi : -ci.lo;
    return fmt::format(" [{:.4f}, {:.4f}]", lo, hi);
  };
  switch (change.verdict) {
    case metrics::ChangeVerdict::kBetter:
      return "better" + by + interval(-1.0);
    case metrics::ChangeVerdict::kWorse:
      return "worse" + by + interval(1.0);
    case metrics::ChangeVerdict::kSame:
      return "the same";
    case metrics::ChangeVerdict::kNotTold:
      break;
  }
  return change.is_judged ? "no change larger than the noise" : "cannot be told, too few frames";
}

}  // namespace

std::string AgainstText(const metrics::Against& against) {
  std::string text =
      fmt::format("against {} ({}):\n", against.earlier,
                  against.common_frames > 0 ? fmt::format("{} common frames, paired", against.common_frames)
                                            : "by intervals, because there are too few common frames");
  for (const metrics::FigureChange& change : against.figures) {
    if (!change.headline) continue;
    const std::string label =
        fmt::format("{}, {}", change.path == "iou" ? "IoU" : "intensity error", change.fan ? "fan" : "polar");
    text += fmt::format("  {:<24}  {:.4f} before, {:.4f} now: {}\n", label, change.earlier, change.now,
                        VerdictWithAmount(change));
    if (change.explained) {
      text += fmt::format("  {:<24}  {:.0f} % of the way to the floor\n", "", 100.0 * *change.explained);
    }
  }
  const auto not_judged = std::ranges::count(against.figures, false, &metrics::FigureChange::is_judged);
  text += fmt::format("  all {} figures: {} better, {} worse, {} the same, {} within the noise",
                      against.figures.size(), against.Count(metrics::ChangeVerdict::kBetter, false),
                      against.Count(metrics::ChangeVerdict::kWorse, false),
                      against.Count(metrics::ChangeVerdict::kSame, false),
                      against.Count(metrics::ChangeVerdict::kNotTold, false) - not_judged);
  text += not_judged > 0 ? fmt::format(", {} cannot be told\n", not_judged) : "\n";
  for (const std::string& note : against.notes) text += "  note: " + note + "\n";
  return text;
}

}  // namespace sonarcal::report
