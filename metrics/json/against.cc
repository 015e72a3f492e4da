#include "metrics/json/against.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <nlohmann/json.hpp>

#include "data_io/json/json_document.h"
#include "metrics/figures.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal::metrics {
namespace {

// Value at a path such as "intensity.union.rmse" below a node; null if there is none.
const nlohmann::json& At(const nlohmann::json& view, std::string_view path) {
  static const nlohmann::json kNone;
  const nlohmann::json* node = &view;
  while (!path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    const std::string key(path.substr(0, dot));
    if (!node->contains(key)) return kNone;  // only objects contain keys
    node = &(*node)[key];
    path.remove_prefix(std::min(dot + 1, path.size()));
  }
  return *node;
}

std::optional<double> NumberAt(const nlohmann::json& view, std::string_view path) {
  const nlohmann::json& number = At(view, path);
  return number.is_number() ? std::optional(number.get<double>()) : std::nullopt;
}

std::optional<Interval> IntervalAt(const nlohmann::json& view, const std::string& path) {
  const nlohmann::json& ci = At(view, path + "_ci");
  if (!ci.is_array() || ci.size() != 2 || !ci[0].is_number() || !ci[1].is_number()) return std::nullopt;
  return Interval{ci[0].get<double>(), ci[1].get<double>()};
}

const nlohmann::json& ViewOf(const nlohmann::json& summary, bool fan) {
  return fan ? At(summary, "fan") : summary;
}

// One frame in both comparisons.
struct Pair {
  const FrameMetrics* now = nullptr;
  const nlohmann::json* earlier = nullptr;
};

std::vector<Pair> CommonFrames(const MetricsReport& now, const nlohmann::json& earlier) {
  std::map<std::pair<int, std::string>, const nlohmann::json*> frames;
  const nlohmann::json& listed = At(earlier, "frames");
  if (!listed.is_array()) return {};
  for (const nlohmann::json& frame : listed) {
    const nlohmann::json& index = At(frame, "index");
    const nlohmann::json& name = At(frame, "name");
    if (!index.is_number_integer()) continue;
    frames[{index.get<int>(), name.is_string() ? name.get<std::string>() : std::string()}] = &frame;
  }
  std::vector<Pair> pairs;
  for (const FrameMetrics& frame : now.frames) {
    const auto found = frames.find({frame.index, frame.name});
    if (found != frames.end()) pairs.push_back({&frame, found->second});
  }
  return pairs;
}

// Values to average of one figure, in the frames that define it in both runs.
struct PairedSeries {
  std::vector<double> now;
  std::vector<double> earlier;
};

PairedSeries SeriesOf(const std::vector<Pair>& pairs, const Figure& figure, bool fan) {
  PairedSeries series;
  for (const Pair& pair : pairs) {
    const std::optional<double> now = figure.averaged(fan ? pair.now->fan : pair.now->polar);
    const std::optional<double> figure_then = NumberAt(ViewOf(*pair.earlier, fan), figure.path);
    const std::optional<double> then = figure_then ? figure.Unfinish(*figure_then) : std::nullopt;
    if (!now || !then) continue;
    series.now.push_back(*now);
    series.earlier.push_back(*then);
  }
  return series;
}

// Verdict of an interval. `size` is the magnitude of the figure, relative to which rounding is ignored.
ChangeVerdict VerdictOf(const Interval& ci, double size) {
  constexpr double kRounding = 1e-12;
  if (std::max(std::abs(ci.lo), std::abs(ci.hi)) <= kRounding * size) return ChangeVerdict::kSame;
  if (ci.lo > 0.0) return ChangeVerdict::kWorse;
  return ci.hi < 0.0 ? ChangeVerdict::kBetter : ChangeVerdict::kNotTold;
}

// Increase of the badness of the mean over the frames in `indices`.
std::optional<double> Worsening(const Figure& figure, const PairedSeries& series,
                                std::span<const int> indices) {
  double now = 0.0;
  double earlier = 0.0;
  for (const int i : indices) {
    now += series.now[i];
    earlier += series.earlier[i];
  }
  const auto count = static_cast<double>(indices.size());
  const std::optional<double> figure_now = figure.Finish(now / count);
  const std::optional<double> figure_then = figure.Finish(earlier / count);
  if (!figure_now || !figure_then) return std::nullopt;
  return *figure.Badness(*figure_now) - *figure.Badness(*figure_then);
}

void SetPairedVerdict(const Figure& figure, const PairedSeries& series, bool in_time, FigureChange& change) {
  const int count = static_cast<int>(series.now.size());
  std::vector<int> all(count);
  std::vector<double> differences(count);
  for (int i = 0; i < count; ++i) {
    all[i] = i;
    differences[i] = series.now[i] - series.earlier[i];
  }
  const std::optional<double> worsening = Worsening(figure, series, all);
  if (!worsening) return;
  change.worsening = *worsening;
  FrameResampler resampler(count, in_time ? PolitisWhiteBlockLength(differences) : 1);
  std::vector<double> draws;
  for (int draw = 0; draw < kBootstrapDraws; ++draw) {
    if (const auto drawn = Worsening(figure, series, resampler.Next())) draws.push_back(*drawn);
  }
  if (draws.empty()) return;
  change.worsening_ci = PercentileInterval95(std::move(draws));
  change.is_judged = true;
  change.verdict = VerdictOf(*change.worsening_ci, std::abs(change.earlier));
}

void SetVerdictByIntervals(const std::optional<Interval>& now, const std::optional<Interval>& earlier,
                           FigureChange& change) {
  change.is_judged = change.now == change.earlier || (now && earlier);
  if (change.now == change.earlier) {
    change.verdict = ChangeVerdict::kSame;
  } else if (now && earlier && (now->lo > earlier->hi || now->hi < earlier->lo)) {
    change.verdict = change.worsening > 0.0 ? ChangeVerdict::kWorse : ChangeVerdict::kBetter;
  }
}

// Differences in the compared data or settings that change figures by themselves.
std::vector<std::string> Notes(const MetricsReport& now, const nlohmann::json& now_json,
                               const nlohmann::json& earlier, const std::vector<Pair>& pairs) {
  std::vector<std::string> notes;
  const auto differ = [&](const char* key) {
    return earlier.contains(key) && now_json.contains(key) && earlier[key] != now_json[key];
  };
  if (differ("real")) {
    notes.push_back(fmt::format("the earlier comparison was with {}, this one is with {}",
                                earlier["real"].is_string() ? earlier["real"].get<std::string>() : "another",
                                now.real));
  }
  if (differ("segmentation")) {
    notes.emplace_back("the earlier comparison found the object by other settings of the segmentation");
  }
  const auto other_object = std::count_if(pairs.begin(), pairs.end(), [](const Pair& pair) {
    return NumberAt(*pair.earlier, "nr") != static_cast<double>(pair.now->polar.occupancy.nr);
  });
  if (other_object > 0) {
    notes.push_back(fmt::format("in {} of {} common frames the recorded object has another size than before",
                                other_object, pairs.size()));
  }
  return notes;
}

nlohmann::json ParseComparison(const std::string& text, const std::string& name) {
  auto json = data_io::ParseLeniently(text);
  if (!json.is_object() || json.value("format", nlohmann::json()) != "sonar-metrics/1" ||
      !json.contains("macro"))
    throw DataError("{}: found no comparison, expected a metrics.json of format sonar-metrics/1", name);
  return json;
}

}  // namespace

int Against::Count(ChangeVerdict verdict, bool headline_only) const {
  return static_cast<int>(std::count_if(figures.begin(), figures.end(), [&](const FigureChange& change) {
    return change.verdict == verdict && (change.headline || !headline_only);
  }));
}

std::optional<double> ExplainedFraction(double badness_before, double badness_after, double badness_floor) {
  if (!(badness_before > badness_floor)) return std::nullopt;
  return (badness_before - badness_after) / (badness_before - badness_floor);
}

void CheckIsComparison(const std::string& earlier_text, const std::string& earlier_name) {
  ParseComparison(earlier_text, earlier_name);
}

Against CompareAgainst(const MetricsReport& now, const std::string& earlier_text,
                       const std::string& earlier_name) {
  const nlohmann::json earlier = ParseComparison(earlier_text, earlier_name);
  const nlohmann::json& macro = earlier["macro"];
  const std::vector<Pair> pairs = CommonFrames(now, earlier);
  const bool paired = static_cast<int>(pairs.size()) >= kBootstrapMinFrames;
  const nlohmann::json now_json = nlohmann::json::parse(MetricsSummaryJson(now));
  Against against{.earlier = earlier_name,
                  .common_frames = paired ? static_cast<int>(pairs.size()) : 0,
                  .figures = {},
                  .notes = Notes(now, now_json, earlier, pairs)};
  const Aggregate* floor = now.noise_floor.Beside();
  const std::string error_path = IntensityErrorPath(now.options.intensity_domain);
  for (const bool fan : {false, true}) {
    const ViewSummary& view = fan ? now.aggregate.macro.fan : now.aggregate.macro.polar;
    const nlohmann::json& view_then = ViewOf(macro, fan);
    for (std::size_t f = 0; f < Figures().size(); ++f) {
      const Figure& figure = Figures()[f];
      const std::optional<double> then = NumberAt(view_then, figure.path);
      const Statistic& statistic = view.statistics[f];
      if (figure.better == Better::kNeither || !then) continue;
      const bool is_headline = figure.path == "iou" || figure.path == error_path;
      const std::string name = fmt::format("{}, {}", figure.path, fan ? "fan" : "polar");
      if (!statistic.value) {
        if (is_headline) against.unknown.push_back(name + " (without value now)");
        continue;
      }
      FigureChange change{.fan = fan,
                          .path = figure.path,
                          .headline = is_headline,
                          .earlier = *then,
                          .now = *statistic.value};
      const double badness_then = *figure.Badness(*then);
      const double badness_now = *figure.Badness(*statistic.value);
      change.worsening = badness_now - badness_then;
      const PairedSeries series = paired ? SeriesOf(pairs, figure, fan) : PairedSeries();
      if (static_cast<int>(series.now.size()) >= kBootstrapMinFrames) {
        SetPairedVerdict(figure, series, now.aggregate.in_time, change);
      } else {
        SetVerdictByIntervals(statistic.ci, IntervalAt(view_then, figure.path), change);
      }
      if (is_headline && !change.is_judged) against.unknown.push_back(name + " (too few frames)");
      if (floor != nullptr) {
        const ViewSummary& floor_view = fan ? floor->macro.fan : floor->macro.polar;
        if (const std::optional<double>& best = floor_view.statistics[f].value) {
          change.explained = ExplainedFraction(badness_then, badness_now, *figure.Badness(*best));
        }
      }
      against.figures.push_back(std::move(change));
    }
  }
  if (!against.unknown.empty()) {
    against.notes.push_back(
        fmt::format("nothing tells whether {} got worse", fmt::join(against.unknown, " and ")));
  }
  return against;
}

}  // namespace sonarcal::metrics
