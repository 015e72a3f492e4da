// Compares a comparison with an earlier one, from its metrics.json: figures that became better or worse, and
// whether the change is significant.
//
// If at least kBootstrapMinFrames frames occur in both (same index and name), the runs are paired. Frames are
// drawn with replacement, as in metrics/bootstrap.h, the same frames of both runs. A change of the mean over
// frames is significant if its 95 % confidence interval excludes 0. Pairing removes the variation between
// easy and hard frames. Without enough common frames, the two 95 % confidence intervals are compared; if
// either is missing, there is no verdict.
//
// metrics/figures.h defines which direction is better. One unchanged figure in twenty appears as changed by
// chance. The verdicts of the few headline figures (IoU and the intensity error, polar and fan) are therefore
// counted separately.
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

// Means over frames of one figure, earlier and now.
struct FigureChange {
  bool fan = false;
  std::string path;  // metrics/figures.h
  bool headline = false;
  double earlier = 0.0;
  double now = 0.0;
  // Increase of Figure::Badness: over the common frames if paired, otherwise of the means.
  double worsening = 0.0;
  std::optional<Interval> worsening_ci = {};  // if paired
  ChangeVerdict verdict = ChangeVerdict::kNotTold;
  bool is_judged = false;  // false: too few frames define the figure for an interval, so nothing is known
  // (earlier - now) / (earlier - floor) of the badness: 1 if the change reached the noise floor. None if no
  // floor is known or the earlier figure was not worse than it.
  std::optional<double> explained = {};
};

struct Against {
  std::string earlier;    // name of its file
  int common_frames = 0;  // number of paired frames; 0: intervals are compared
  std::vector<FigureChange> figures;
  // Headline figures of which nothing is known: those that are not judged, and those with a value in the
  // earlier run only.
  std::vector<std::string> unknown = {};
  std::vector<std::string> notes;  // differences that make the two runs hard to compare, one sentence each

  int Count(ChangeVerdict verdict, bool headline_only) const;
};

// Throws DataError if the text is no metrics.json, before a long comparison.
void CheckIsComparison(const std::string& earlier_text, const std::string& earlier_name);

// `earlier_text` is the text of a metrics.json, `earlier_name` its name in messages. Throws DataError if the
// text is not valid.
Against CompareAgainst(const MetricsReport& now, const std::string& earlier_text,
                       const std::string& earlier_name);

// Achieved fraction of the possible improvement; none if no improvement was possible.
std::optional<double> ExplainedFraction(double badness_before, double badness_after, double badness_floor);

}  // namespace sonarcal::metrics
