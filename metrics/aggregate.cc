#include "metrics/aggregate.h"

#include <array>
#include <cmath>
#include <span>

namespace sonarcal {
namespace {

// How one statistic follows from a view. What is averaged over frames is `of`; `finish` is applied last.
struct Definition {
  Statistic& (*in)(ViewSummary&);
  std::optional<double> (*of)(const ViewMetrics&);
  double (*finish)(double) = [](double value) { return value; };
};

template <DifferenceSummary ViewSummary::*summary, DifferenceSums IntensityError::*sums>
constexpr Definition kMeanAbsolute = {
    [](ViewSummary& view) -> Statistic& { return (view.*summary).mean_absolute; },
    [](const ViewMetrics& view) { return (view.intensity.*sums).mean_absolute(); }};

template <DifferenceSummary ViewSummary::*summary, DifferenceSums IntensityError::*sums>
constexpr Definition kRmse = {[](ViewSummary& view) -> Statistic& { return (view.*summary).rmse; },
                              [](const ViewMetrics& view) { return (view.intensity.*sums).mean_square(); },
                              [](double mean_square) { return std::sqrt(mean_square); }};

template <DifferenceSummary ViewSummary::*summary, DifferenceSums IntensityError::*sums>
constexpr Definition kBias = {[](ViewSummary& view) -> Statistic& { return (view.*summary).bias; },
                              [](const ViewMetrics& view) { return (view.intensity.*sums).bias(); }};

constexpr std::array kDefinitions = {
    Definition{[](ViewSummary& view) -> Statistic& { return view.ns_over_nr; },
               [](const ViewMetrics& view) { return view.occupancy.ns_over_nr(); }},
    Definition{[](ViewSummary& view) -> Statistic& { return view.na_over_ns; },
               [](const ViewMetrics& view) { return view.occupancy.na_over_ns(); }},
    Definition{[](ViewSummary& view) -> Statistic& { return view.na_over_nr; },
               [](const ViewMetrics& view) { return view.occupancy.na_over_nr(); }},
    Definition{[](ViewSummary& view) -> Statistic& { return view.iou; },
               [](const ViewMetrics& view) { return view.occupancy.iou(); }},
    kMeanAbsolute<&ViewSummary::union_region, &IntensityError::union_region>,
    kMeanAbsolute<&ViewSummary::whole, &IntensityError::whole>,
    kMeanAbsolute<&ViewSummary::overlap, &IntensityError::overlap>,
    kRmse<&ViewSummary::union_region, &IntensityError::union_region>,
    kRmse<&ViewSummary::whole, &IntensityError::whole>,
    kRmse<&ViewSummary::overlap, &IntensityError::overlap>,
    kBias<&ViewSummary::union_region, &IntensityError::union_region>,
    kBias<&ViewSummary::whole, &IntensityError::whole>,
    kBias<&ViewSummary::overlap, &IntensityError::overlap>,
};

// A frame's value of every definition.
using Values = std::array<std::optional<double>, kDefinitions.size()>;

struct FrameView {
  ViewMetrics metrics;
  Values values;
};

Values Evaluate(const ViewMetrics& metrics) {
  Values values;
  for (std::size_t d = 0; d < kDefinitions.size(); ++d) values[d] = kDefinitions[d].of(metrics);
  return values;
}

Values Finish(Values values) {
  for (std::size_t d = 0; d < kDefinitions.size(); ++d) {
    if (values[d]) values[d] = kDefinitions[d].finish(*values[d]);
  }
  return values;
}

// Of the frames named by `indices`, a frame as often as it is named.
Values MacroValues(const std::vector<FrameView>& frames, std::span<const int> indices) {
  Values means;
  for (std::size_t d = 0; d < kDefinitions.size(); ++d) {
    double sum = 0.0;
    int used = 0;
    for (const int i : indices) {
      if (!frames[i].values[d]) continue;
      sum += *frames[i].values[d];
      ++used;
    }
    if (used > 0) means[d] = sum / used;
  }
  return Finish(means);
}

ViewMetrics Pool(const std::vector<FrameView>& frames, std::span<const int> indices) {
  ViewMetrics pooled;
  for (const int i : indices) pooled += frames[i].metrics;
  return pooled;
}

void CheckIdentity(const Occupancy& pooled) {
  if (!pooled.na_over_ns() || !pooled.ns_over_nr()) return;
  const double product = *pooled.na_over_ns() * *pooled.ns_over_nr();
  SONARCAL_CHECK(std::abs(*pooled.na_over_nr() - product) <= 1e-12 * (1.0 + product),
                 "Na/Nr = {} but (Na/Ns)(Ns/Nr) = {}", *pooled.na_over_nr(), product);
}

// The values of one way of aggregating, and its values over the bootstrap's draws.
class Summarizer {
 public:
  explicit Summarizer(const Values& values) : values_(values) {}

  void AddDraw(const Values& values) {
    for (std::size_t d = 0; d < kDefinitions.size(); ++d) {
      if (values[d]) draws_[d].push_back(*values[d]);
    }
  }

  // `frames_used(d)`: how many frames went into definition d.
  template <typename FramesUsed>
  ViewSummary Summary(int frame_count, FramesUsed frames_used) const {
    ViewSummary summary;
    for (std::size_t d = 0; d < kDefinitions.size(); ++d) {
      Statistic& statistic = kDefinitions[d].in(summary);
      statistic.value = values_[d];
      statistic.frames_used = frames_used(d);
      statistic.frames_left_out = frame_count - statistic.frames_used;
      if (statistic.frames_used >= kBootstrapMinFrames && !draws_[d].empty()) {
        statistic.ci = PercentileInterval95(draws_[d]);
      }
    }
    return summary;
  }

 private:
  Values values_;
  std::array<std::vector<double>, kDefinitions.size()> draws_;
};

struct ViewAggregate {
  ViewSummary macro;
  ViewSummary micro;
  ViewMetrics pooled;
};

ViewAggregate AggregateView(const std::vector<FrameMetrics>& frames, ViewMetrics FrameMetrics::*view) {
  std::vector<FrameView> views;
  std::vector<int> all;
  for (const FrameMetrics& frame : frames) {
    all.push_back(static_cast<int>(views.size()));
    views.push_back({frame.*view, Evaluate(frame.*view)});
  }
  const int frame_count = static_cast<int>(views.size());
  const ViewMetrics pooled = Pool(views, all);
  CheckIdentity(pooled.occupancy);

  Summarizer macro(MacroValues(views, all));
  Summarizer micro(Finish(Evaluate(pooled)));
  if (frame_count >= kBootstrapMinFrames) {
    FrameResampler resampler(frame_count);
    for (int draw = 0; draw < kBootstrapDraws; ++draw) {
      const std::span<const int> indices = resampler.Next();
      macro.AddDraw(MacroValues(views, indices));
      micro.AddDraw(Finish(Evaluate(Pool(views, indices))));
    }
  }
  const auto frames_defining = [&](std::size_t d) {
    int used = 0;
    for (const FrameView& frame : views) used += frame.values[d].has_value();
    return used;
  };
  return {macro.Summary(frame_count, frames_defining),
          micro.Summary(frame_count, [&](std::size_t) { return frame_count; }), pooled};
}

}  // namespace

const DifferenceSummary& ViewSummary::Over(IntensityDomain domain) const {
  switch (domain) {
    case IntensityDomain::kWhole:
      return whole;
    case IntensityDomain::kOverlap:
      return overlap;
    case IntensityDomain::kUnion:
      break;
  }
  return union_region;
}

Aggregate AggregateFrames(const std::vector<FrameMetrics>& frames) {
  const ViewAggregate polar = AggregateView(frames, &FrameMetrics::polar);
  const ViewAggregate fan = AggregateView(frames, &FrameMetrics::fan);
  Aggregate aggregate{.frame_count = static_cast<int>(frames.size()),
                      .macro = {polar.macro, fan.macro},
                      .micro = {polar.micro, fan.micro},
                      .pooled_polar = polar.pooled,
                      .pooled_fan = fan.pooled,
                      .no_interval_reason = {}};
  if (aggregate.frame_count < kBootstrapMinFrames) {
    aggregate.no_interval_reason =
        fmt::format("{} frame{}, an interval needs at least {}", aggregate.frame_count,
                    aggregate.frame_count == 1 ? "" : "s", kBootstrapMinFrames);
  }
  return aggregate;
}

}  // namespace sonarcal
