#include "apps/report/sections/agreement_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/report/html/html_text.h"
#include "apps/report/sections/figure_words.h"
#include "apps/report/sections/residual_section.h"
#include "metrics/figures.h"
#include "metrics/segmentation/scored_image.h"

namespace sonarcal::report {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kMaxClasses = 128;  // classes of a histogram
constexpr int kRangeBands = 8;
constexpr double kHighestRatio = 2.0;  // upper end of the axis

std::string Interval95(const metrics::Statistic& statistic) {
  return statistic.ci ? fmt::format(" (95 %: {})", IntervalText(statistic)) : std::string();
}

std::string OccupancyInWords(const metrics::MetricsReport& metrics) {
  const metrics::ViewSummary& macro = metrics.aggregate.macro.polar;
  const metrics::Statistic& iou = macro.At("iou");
  if (!iou.value) return "No object was found in either image of any frame.";
  std::string text =
      fmt::format("The object regions share {:.0f} % of their joint area{}", 100.0 * *iou.value,
                  iou.ci ? fmt::format(" (IoU {}, 95 %: {})", FigureText(iou.value), IntervalText(iou))
                         : fmt::format(" (IoU {})", FigureText(iou.value)));
  const std::optional<double> size = macro.At("ns_over_nr").value;
  const std::optional<double> covered = macro.At("na_over_nr").value;
  if (size && covered) {
    text +=
        fmt::format("; the simulated one is {:.2f} times as large as the {} one and covers {:.0f} % of it",
                    *size, RealWord(metrics.real_is_synthetic), 100.0 * *covered);
  }
  if (const std::optional<double> apart_m = macro.At("outline.mean_m").value) {
    text += fmt::format("; their outlines lie {:.3g} m apart on average", *apart_m);
  }
  return text + ".";
}

std::string IntensityInWords(const metrics::MetricsReport& metrics) {
  const metrics::IntensityDomain domain = metrics.options.intensity_domain;
  const metrics::DifferenceSummary of = metrics.aggregate.macro.polar.Over(domain);
  if (!of.mean_absolute.value) return {};
  std::string text =
      fmt::format("Over {} the grey values differ by {} of full scale on average{}", DomainText(domain),
                  FigureText(of.mean_absolute.value), Interval95(of.mean_absolute));
  if (const std::optional<double> span_db = metrics::DbSpan(metrics.scale)) {
    text += fmt::format(", which is {:.1f} dB of the display", *of.mean_absolute.value * *span_db);
  }
  if (of.bias.value) {
    text += fmt::format("; the simulated image is {} by {} on average",
                        *of.bias.value > 0.0 ? "brighter" : "darker", FigureText(std::abs(*of.bias.value)));
  }
  return text + ".";
}

// Sentence about the floor if it was not measured.
std::string SpeckleInWords(const metrics::NoiseFloor& floor) {
  const std::string& reason = floor.real_against_real.absent_reason;
  const std::string unmeasured =
      fmt::format("The best value that any simulation could reach on this recording was not measured{}.",
                  reason.empty() ? "" : ": " + reason);
  if (!floor.speckle) return unmeasured + " Its display states no dB, so theory gives no value either.";
  return fmt::format(
      "{} In theory, with single-look speckle and without clipping, an expected image differs by {} on "
      "average and a speckled sample by {}.",
      unmeasured, FigureText(floor.speckle->smooth_simulation),
      FigureText(floor.speckle->speckled_simulation));
}

std::string FloorInWords(const metrics::MetricsReport& metrics) {
  const metrics::Aggregate* floor = metrics.noise_floor.Beside();
  const metrics::IntensityDomain domain = metrics.options.intensity_domain;
  const std::optional<double> error = metrics.aggregate.macro.polar.Over(domain).mean_absolute.value;
  const std::optional<double> best =
      floor == nullptr ? std::nullopt : floor->macro.polar.Over(domain).mean_absolute.value;
  if (!error) return {};
  if (best == 0.0) {
    return "The best value that any simulation could reach on this recording is unknown: its frames of one "
           "static scene are identical.";
  }
  if (!best) return SpeckleInWords(metrics.noise_floor);
  return fmt::format(
      "The best value that any simulation could reach on this recording is about {}: the error is {:.2f} "
      "times that. {}",
      FigureText(best), *error / *best, FloorNote(metrics.noise_floor));
}

std::string WorstInWords(const metrics::MetricsReport& metrics) {
  if (metrics.residuals.frames() == 0) return {};
  const auto worst = FindWorstBand(metrics.residuals.ByRange(), kRangeBands);
  if (!worst) return {};
  return fmt::format(
      "The error is largest at {:.2f} to {:.2f} m: {} of full scale on average over the pixels of all "
      "frames, the simulated image {} by {}.",
      worst->from, worst->to, FigureText(worst->mean_absolute), worst->bias > 0.0 ? "brighter" : "darker",
      FigureText(std::abs(worst->bias)));
}

// Shares of the levels, grouped for a chart; x in grey levels of `full_scale`.
ChartSeries HistogramSeries(const std::string& name, const std::vector<double>& counts, double full_scale,
                            int colour) {
  ChartSeries series{.name = name, .x = {}, .y = {}, .colour = colour};
  double total = 0.0;
  for (const double count : counts) total += count;
  const std::size_t group = (counts.size() + kMaxClasses - 1) / kMaxClasses;
  for (std::size_t first = 0; first < counts.size(); first += group) {
    const std::size_t end = std::min(counts.size(), first + group);
    double sum = 0.0;
    for (std::size_t level = first; level < end; ++level) sum += counts[level];
    series.x.push_back(0.5 * static_cast<double>(first + end - 1) * full_scale /
                       static_cast<double>(counts.size() - 1));
    series.y.push_back(total > 0.0 ? 100.0 * sum / total : kNaN);
  }
  return series;
}

// Returns the levels, in grey levels, below which the given shares of the pixels lie.
std::vector<double> Quantiles(const std::vector<double>& counts, const std::vector<double>& shares,
                              double full_scale) {
  double total = 0.0;
  for (const double count : counts) total += count;
  std::vector<double> quantiles;
  std::size_t level = 0;
  double below = counts.front();
  for (const double share : shares) {
    while (below < share * total && level + 1 < counts.size()) below += counts[++level];
    quantiles.push_back(static_cast<double>(level) * full_scale / static_cast<double>(counts.size() - 1));
  }
  return quantiles;
}

LineChart HistogramChart(const metrics::LevelCounts& counts, const std::string& title, double full_scale,
                         const std::string& real) {
  return {.title = title,
          .x = {.label = "grey level"},
          .y = {.label = "pixels", .unit = "%"},
          .series = {HistogramSeries(real, counts.real, full_scale, 0),
                     HistogramSeries("simulated", counts.simulated, full_scale, 1)},
          .alt = title + ": histograms of the " + real + " and the simulated grey values"};
}

LineChart QuantileChart(const metrics::LevelCounts& counts, const std::string& title, double full_scale,
                        const std::string& real) {
  std::vector<double> shares;
  for (int i = 1; i < 100; ++i) shares.push_back(0.01 * i);
  for (const double share : {0.995, 0.999}) shares.push_back(share);
  ChartSeries quantiles{.name = "quantiles, 1 % to 99.9 %",
                        .x = Quantiles(counts.real, shares, full_scale),
                        .y = Quantiles(counts.simulated, shares, full_scale),
                        .style = SeriesStyle::kPoints,
                        .colour = 1};
  const double end = std::max(quantiles.x.back(), quantiles.y.back());
  return {
      .title = title,
      .x = {.label = real + " grey level", .min = 0.0},
      .y = {.label = "simulated grey level", .min = 0.0},
      .series = {{"equal", {0.0, end}, {0.0, end}, SeriesStyle::kDashed, {}, {}, 5}, std::move(quantiles)},
      .alt = title + ": quantiles of the simulated over those of the " + real + " grey values"};
}

}  // namespace

std::vector<std::string> SummaryInWords(const metrics::MetricsReport& metrics) {
  std::vector<std::string> sentences = {OccupancyInWords(metrics), IntensityInWords(metrics),
                                        FloorInWords(metrics), WorstInWords(metrics)};
  if (!metrics.aggregate.no_interval_reason.empty()) {
    sentences.push_back("No confidence intervals can be given: " + metrics.aggregate.no_interval_reason +
                        ".");
  }
  std::erase_if(sentences, [](const std::string& sentence) { return sentence.empty(); });
  return sentences;
}

void AddThresholdSweep(HtmlReport& report, const metrics::MetricsReport& metrics) {
  if (!metrics.sweep) return;
  const metrics::ThresholdSweep& sweep = *metrics.sweep;
  static constexpr const char* kLabels[metrics::kSweepRatios] = {"Ns/Nr", "Na/Ns", "Na/Nr", "IoU", "Dice"};
  LineChart chart{.title = "Ratios over the threshold",
                  .x = {.label = std::string(metrics::SettingUnit(metrics.options.segmentation.method))},
                  .y = {.label = "ratio of pooled counts", .min = 0.0, .max = kHighestRatio},
                  .alt = "Occupancy ratios as curves over the setting of the segmentation"};
  Table areas{.caption = "Mean height of the curves",
              .columns = {{"Ratio"}, {"Pixels pooled"}, {"Mean of frames"}, {"Share of the axis", "%"}},
              .rows = {},
              .notes = {"The area under a curve over the length of the axis on which the ratio is defined."}};
  for (int ratio = 0; ratio < metrics::kSweepRatios; ++ratio) {
    const auto micro = sweep.MicroCurve(ratio);
    ChartSeries series{.name = kLabels[ratio], .x = sweep.settings(), .y = {}};
    for (const std::optional<double>& height : micro) series.y.push_back(height.value_or(kNaN));
    chart.series.push_back(std::move(series));
    const std::optional<metrics::SweepArea> pooled = sweep.AreaUnder(micro);
    const std::optional<metrics::SweepArea> mean = sweep.AreaUnder(sweep.MacroCurve(ratio));
    const auto area = [](const std::optional<metrics::SweepArea>& of) {
      return FigureText(of ? std::optional(of->area) : std::nullopt);
    };
    areas.rows.push_back({{kLabels[ratio], area(pooled), area(mean),
                           pooled ? fmt::format("{:.0f}", 100.0 * pooled->axis_share) : "0"}});
  }
  report.Add({chart},
             fmt::format("Occupancy over the threshold of the segmentation. The chart ends at Ns/Nr = {:g}.",
                         kHighestRatio));
  report.Add(areas);
}

void AddGreyLevels(HtmlReport& report, const metrics::MetricsReport& metrics) {
  const metrics::LevelHistograms& levels = metrics.aggregate.pooled_levels.polar;
  for (const auto& [domain, name] : {std::pair{metrics::LevelDomain::kUnion, "Object regions"},
                                     std::pair{metrics::LevelDomain::kWhole, "Whole image"}}) {
    const metrics::LevelCounts& counts = levels.Over(domain);
    const bool is_empty = std::ranges::all_of(counts.real, [](double count) { return count == 0.0; });
    if (is_empty || counts.real.size() < 2) continue;
    const double full_scale = metrics.scale.full_scale;
    const std::string real = RealWord(metrics.real_is_synthetic);
    report.Add({HistogramChart(counts, fmt::format("{}: grey values", name), full_scale, real),
                QuantileChart(counts, fmt::format("{}: quantiles", name), full_scale, real)},
               fmt::format("{}: histograms of the grey values, and the quantiles of one image over those of "
                           "the other. On the dashed line both distributions are equal.",
                           name));
  }
}

void AddEveryFigure(HtmlReport& report, const metrics::MetricsReport& metrics) {
  const metrics::Aggregate* floor = metrics.noise_floor.Beside();
  Table table{
      .caption = "Every figure of the polar images",
      .columns = {{"Figure"}, {"Unit", {}, false}, {"Mean of frames"}, {"95 %"}, {"Pixels pooled"}},
      .rows = {},
      .notes = {"Formulas and sources: docs/reference/metrics.md. Figures without any value are left out."}};
  if (floor != nullptr) {
    table.columns.push_back({"Floor of the mean"});
    table.notes.push_back(FloorNote(metrics.noise_floor));
  }
  for (const metrics::Figure& figure : metrics::Figures()) {
    const metrics::Statistic& macro = metrics.aggregate.macro.polar.At(figure.path);
    const metrics::Statistic& micro = metrics.aggregate.micro.polar.At(figure.path);
    if (!macro.value && !micro.value) continue;
    TableRow row{{figure.label, UnitText(figure.unit), FigureText(macro.value), IntervalText(macro),
                  FigureText(micro.value)}};
    if (floor != nullptr) row.cells.push_back(FigureText(floor->macro.polar.At(figure.path).value));
    table.rows.push_back(std::move(row));
  }
  report.Add(table);
}

}  // namespace sonarcal::report
