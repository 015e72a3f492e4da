// A comparison against an earlier one, from its metrics.json: what got better or worse, and whether by more
// than the noise.
//
// Where at least kBootstrapMinFrames frames stand in both (same index and name), the two are paired: frames
// are drawn with replacement, as in metrics/bootstrap.h, the same ones of both, and the change of the mean
// over frames is larger than the noise where its 95 % interval does not hold 0. Pairing matters: what makes a
// frame hard is the same for both. Else the two 95 % intervals decide, and where either is missing nothing is
// told.
//
// Which way is better stands in metrics/figures.h. One figure in twenty that did not change is taken for one
// that did; verdicts of the few headline figures (IoU and the intensity error, polar and fan) are counted
// apart for that reason.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/types/words.h"
#include "metrics/bootstrap.h"

namespace sonarcal::metrics {

struct MetricsReport;  // metrics/json/metrics_json.h

enum class ChangeVerdict { kBetter, kWorse, kSame, kNotTold };
constexpr auto WordsOf(std::type_identity<ChangeVerdict>) {
  return Words<ChangeVerdict, 4>{{{"better", ChangeVerdict::kBetter},
                                  {"worse", ChangeVerdict::kWorse},
                                  {"same", ChangeVerdict::kSame},
                                  {"not_told", ChangeVerdict::kNotTold}}};
}

// Means over frames of one figure, then and now.
struct FigureChange {
  bool fan = false;
  std::string path;  // metrics/figures.h
  bool headline = false;
  double earlier = 0.0;
  double now = 0.0;
  // What changed towards the worse (Figure::Badness): over the common frames where paired, else of the means.
  double worsening = 0.0;
  std::optional<Interval> worsening_ci = {};  // where paired
  ChangeVerdict verdict = ChangeVerdict::kNotTold;
  // (earlier - now) / (earlier - floor) of the badness: 1 where the change reached what no simulator beats.
  // None where no floor is known or the earlier figure was no worse than it.
  std::optional<double> explained = {};
};

struct Against {
  std::string earlier;    // name of its file
  int common_frames = 0;  // that were paired; 0: intervals decide
  std::vector<FigureChange> figures;
  std::vector<std::string> notes;  // what makes the two hard to compare, one sentence each

  int Count(ChangeVerdict verdict, bool headline_only) const;
};

// `earlier_text` is a metrics.json, `earlier_name` names it for people. Throws DataError where it is none.
Against CompareAgainst(const MetricsReport& now, const std::string& earlier_text,
                       const std::string& earlier_name);

// The share of what a simulator could gain that was gained; none where there was nothing to gain.
std::optional<double> ExplainedFraction(double badness_before, double badness_after, double badness_floor);

}  // namespace sonarcal::metrics
