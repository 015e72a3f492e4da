#include "metrics/aggregate.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "metrics/figures.h"

namespace sonarcal::metrics {
namespace {

// One view of all frames.
struct FrameViews {
  std::vector<const ViewMetrics*> metrics;
  // Values to average, by figure and frame. The frames of a figure are contiguous, because a draw reads one
  // figure of all frames in any order.
  std::vector<std::vector<std::optional<double>>> values;

  std::size_t size() const { return metrics.size(); }
};

std::optional<double> Finish(std::size_t figure, const std::optional<double>& average) {
  return average ? Figures()[figure].Finish(*average) : std::nullopt;
}

// Macro figure of the frames in `indices`, which may name a frame several times.
std::optional<double> Macro(const FrameViews& frames, std::span<const int> indices, std::size_t figure) {
  const std::vector<std::optional<double>>& values = frames.values[figure];
  double sum = 0.0;
  int used = 0;
  for (const int i : indices) {
    const std::optional<double>& value = values[i];
    if (!value) continue;
    sum += *value;
    ++used;
  }
  return used > 0 ? Finish(figure, sum / used) : std::nullopt;
}

ViewMetrics Pool(const FrameViews& frames, std::span<const int> indices) {
  ViewMetrics pooled;
  for (const int i : indices) pooled += *frames.metrics[i];
  return pooled;
}

void CheckIdentity(const Occupancy& pooled) {
  if (!pooled.na_over_ns() || !pooled.ns_over_nr()) return;
  const double product = *pooled.na_over_ns() * *pooled.ns_over_nr();
  SONARCAL_CHECK(std::abs(*pooled.na_over_nr() - product) <= 1e-12 * (1.0 + product),
                 "Na/Nr = {} but (Na/Ns)(Ns/Nr) = {}", *pooled.na_over_nr(), product);
}

bool FollowInTime(const std::vector<FrameMetrics>& frames) {
  const auto not_later = [](const FrameMetrics& a, const FrameMetrics& b) {
    return !a.time_s || !b.time_s || !(*a.time_s < *b.time_s);
  };
  return frames.size() > 1 && std::adjacent_find(frames.begin(), frames.end(), not_later) == frames.end();
}

struct ViewAggregate {
  ViewSummary macro;
  ViewSummary micro;
  ViewMetrics pooled;
};

void SetValues(const FrameViews& frames, std::span<const int> all, ViewAggregate& view) {
  for (std::size_t f = 0; f < Figures().size(); ++f) {
    Statistic& macro = view.macro.statistics[f];
    macro.value = Macro(frames, all, f);
    for (const std::optional<double>& value : frames.values[f]) macro.frames_used += value.has_value();
    macro.frames_left_out = static_cast<int>(frames.size()) - macro.frames_used;
    Statistic& micro = view.micro.statistics[f];
    micro.value = Finish(f, Figures()[f].averaged(view.pooled));
    micro.frames_used = static_cast<int>(frames.size());
  }
}

// Figures grouped by block length; a group shares its draws.
std::map<int, std::vector<std::size_t>> FiguresByBlock(const FrameViews& frames, bool in_time) {
  std::map<int, std::vector<std::size_t>> by_block;
  for (std::size_t f = 0; f < Figures().size(); ++f) {
    std::vector<double> series;
    for (const std::optional<double>& value : frames.values[f]) {
      if (value) series.push_back(*value);
    }
    by_block[in_time ? PolitisWhiteBlockLength(series) : 1].push_back(f);
  }
  return by_block;
}

void SetIntervals(const FrameViews& frames, bool in_time, ViewAggregate& view) {
  const int frame_count = static_cast<int>(frames.size());
  if (frame_count < kBootstrapMinFrames) return;
  for (const auto& [block, figures] : FiguresByBlock(frames, in_time)) {
    std::vector<std::vector<double>> macro(figures.size());
    std::vector<std::vector<double>> micro(figures.size());
    const auto keep = [](std::vector<double>& draws, const std::optional<double>& value) {
      if (value) draws.push_back(*value);
    };
    FrameResampler resampler(frame_count, block);
    for (int draw = 0; draw < kBootstrapDraws; ++draw) {
      const std::span<const int> indices = resampler.Next();
      const ViewMetrics pooled = Pool(frames, indices);
      for (std::size_t k = 0; k < figures.size(); ++k) {
        keep(macro[k], Macro(frames, indices, figures[k]));
        keep(micro[k], Finish(figures[k], Figures()[figures[k]].averaged(pooled)));
      }
    }
    for (std::size_t k = 0; k < figures.size(); ++k) {
      // If few frames define a figure, many draws give it the same value, of pooled frames too.
      const int defined = view.macro.statistics[figures[k]].frames_used;
      const auto set = [&, block = block](Statistic& statistic, const std::vector<double>& draws) {
        statistic.block_frames = block;
        if (statistic.value && defined >= kBootstrapMinFrames && !draws.empty())
          statistic.ci = PercentileInterval95(draws);
      };
      set(view.macro.statistics[figures[k]], macro[k]);
      set(view.micro.statistics[figures[k]], micro[k]);
    }
  }
}

ViewAggregate AggregateView(const std::vector<FrameMetrics>& frames, ViewMetrics FrameMetrics::*view,
                            const LevelHistograms& levels, bool in_time) {
  FrameViews views;
  std::vector<int> all;
  for (const FrameMetrics& frame : frames) {
    all.push_back(static_cast<int>(views.size()));
    views.metrics.push_back(&(frame.*view));
  }
  for (const Figure& figure : Figures()) {
    std::vector<std::optional<double>>& values = views.values.emplace_back();
    for (const ViewMetrics* metrics : views.metrics) values.push_back(figure.averaged(*metrics));
  }
  ViewAggregate aggregate;
  aggregate.pooled = Pool(views, all);
  aggregate.pooled.distribution = levels.Distances();
  CheckIdentity(aggregate.pooled.occupancy);
  SetValues(views, all, aggregate);
  SetIntervals(views, in_time, aggregate);
  return aggregate;
}

}  // namespace

ViewSummary::ViewSummary() : statistics(Figures().size()) {}

const Statistic& ViewSummary::At(std::string_view path) const {
  return statistics[FigureIndex(path)];
}

DifferenceSummary ViewSummary::Over(IntensityDomain domain) const {
  const std::string prefix = fmt::format("intensity.{}.", ToString(domain));
  return {At(prefix + "mean_absolute"), At(prefix + "rmse"), At(prefix + "bias")};
}

Aggregate AggregateFrames(const std::vector<FrameMetrics>& frames, FrameLevels levels) {
  for (const FrameMetrics& frame : frames) {
    if (frame.levels) levels += *frame.levels;
  }
  const bool in_time = FollowInTime(frames);
  ViewAggregate polar = AggregateView(frames, &FrameMetrics::polar, levels.polar, in_time);
  ViewAggregate fan = AggregateView(frames, &FrameMetrics::fan, levels.fan, in_time);
  Aggregate aggregate{.frame_count = static_cast<int>(frames.size()),
                      .in_time = in_time,
                      .macro = {std::move(polar.macro), std::move(fan.macro)},
                      .micro = {std::move(polar.micro), std::move(fan.micro)},
                      .pooled_polar = polar.pooled,
                      .pooled_fan = fan.pooled,
                      .pooled_levels = std::move(levels),
                      .no_interval_reason = {}};
  if (aggregate.frame_count < kBootstrapMinFrames) {
    aggregate.no_interval_reason =
        fmt::format("{} frame{}, an interval needs at least {}", aggregate.frame_count,
                    aggregate.frame_count == 1 ? "" : "s", kBootstrapMinFrames);
  }
  return aggregate;
}

}  // namespace sonarcal::metrics
