#include "apps/report/sections/fit_section.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "apps/report/html/html_text.h"
#include "apps/report/pictures/shown_frames.h"
#include "apps/report/pictures/sonar_picture.h"
#include "apps/report/sections/agreement_section.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/report/sections/figure_words.h"
#include "calib/selection/ping_worth.h"
#include "sim/physics/gsab.h"

namespace sonarcal::report {
namespace {

constexpr double kCurveStepDeg = 0.5;
// Depth of the chart below its maximum. Curves fall without limit towards 90 degrees.
constexpr double kCurveDepthDb = 60.0;
constexpr double kStrongCorrelation = 0.9;
constexpr std::size_t kMapsShown = 3;
constexpr double kMinMapShare = 1e-3;  // share of a frame's pixels; a map does not show fewer
constexpr double kWidestSigmaDb = 5.0;
constexpr std::size_t kCorrelationsShown = 8;

std::string Value(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : "–";
}

const char* StatusText(calib::ParameterStatus status) {
  switch (status) {
    case calib::ParameterStatus::kFree:
      return "fitted";
    case calib::ParameterStatus::kFixed:
      return "fixed";
    case calib::ParameterStatus::kUnidentifiable:
      return "unidentifiable";
    case calib::ParameterStatus::kAtBound:
      return "at a bound";
  }
  return "";
}

RowStyle StyleOf(calib::ParameterStatus status) {
  return status == calib::ParameterStatus::kFree || status == calib::ParameterStatus::kAtBound
             ? RowStyle::kPlain
             : RowStyle::kMuted;
}

// Returns "material.floor" for "material.floor.gsab.A", "display" for "display.db_min".
std::string GroupOf(const std::string& name) {
  if (name.starts_with("material.")) return name.substr(0, name.rfind(".gsab."));
  const std::size_t dot = name.find('.');
  return dot == std::string::npos ? name : name.substr(0, dot);
}

Table ValueTable(const calib::FitReport& fit) {
  Table table{
      .caption = "Parameters",
      .columns = {{"Parameter"},
                  {"Initial"},
                  {"Value"},
                  {"Sigma"},
                  {"Unit", "", false},
                  {"Bounds", "", false},
                  {"Status", "", false}},
      .rows = {},
      .notes = {"Sigma: standard error, from leaving out one block of neighbouring pixels after another, "
                "because neighbours share speckle and errors. It does not include errors of the model."}};
  constexpr std::ptrdiff_t kTruthColumn = 4;
  const bool truth = calib::HasTruth(fit);
  if (truth) {
    table.columns.insert(table.columns.begin() + kTruthColumn, {"Truth"});
    table.notes.emplace_back(
        "Truth: the value that the simulation of this recording used, where it means the same as the fitted "
        "one.");
  }
  std::string group;
  for (const calib::FittedParameter& p : fit.parameters) {
    if (GroupOf(p.name) != group) {
      group = GroupOf(p.name);
      table.rows.push_back({{group}, RowStyle::kGroup});
    }
    std::vector<std::string> cells = {p.name,
                                      Value(p.initial),
                                      Value(p.value),
                                      p.sigma ? Value(*p.sigma) : "–",
                                      p.unit,
                                      fmt::format("{:g} to {:g}", p.lower, p.upper),
                                      StatusText(p.status)};
    if (truth) cells.insert(cells.begin() + kTruthColumn, p.truth ? Value(*p.truth) : "–");
    table.rows.push_back({std::move(cells), StyleOf(p.status)});
  }
  return table;
}

ChartSeries CurveOf(const std::string& name, const GsabParameters<double>& gsab, int colour,
                    SeriesStyle style, const std::function<bool(double)>& shows) {
  ChartSeries series{.name = name, .x = {}, .y = {}, .style = style, .colour = colour};
  for (int step = 0; step * kCurveStepDeg <= 90.0; ++step) {
    const double incidence_deg = step * kCurveStepDeg;
    series.x.push_back(incidence_deg);
    series.y.push_back(shows(incidence_deg) ? sim::GsabDb(gsab, incidence_deg)
                                            : std::numeric_limits<double>::quiet_NaN());
  }
  return series;
}

// The 95 % band, if it is narrow enough to be useful.
ChartSeries BandOf(const calib::FittedCurve& curve) {
  ChartSeries band{
      .name = "95 %", .x = curve.incidence_deg, .y = curve.backscatter_db, .style = SeriesStyle::kBand};
  band.colour = 0;
  for (std::size_t i = 0; i < band.y.size(); ++i) {
    if (!(curve.sigma_db[i] < kWidestSigmaDb)) band.y[i] = std::numeric_limits<double>::quiet_NaN();
    band.low.push_back(band.y[i] - calib::kSigmasOf95 * curve.sigma_db[i]);
    band.high.push_back(band.y[i] + calib::kSigmasOf95 * curve.sigma_db[i]);
  }
  return band;
}

void ClipBelow(std::vector<ChartSeries>& all) {
  double top_db = -std::numeric_limits<double>::infinity();
  for (const ChartSeries& series : all) {
    for (const double y : series.y) top_db = std::isfinite(y) ? std::max(top_db, y) : top_db;
  }
  for (ChartSeries& series : all) {
    for (double& y : series.y) {
      if (y < top_db - kCurveDepthDb) y = std::numeric_limits<double>::quiet_NaN();
    }
  }
}

LineChart CurveChart(const std::string& material, const workflow::RecordingFit& fit) {
  const bool absolute = fit.fit.report.curves_level && fit.fit.report.curves_level->sigma_db;
  LineChart chart{.title = material,
                  .x = {.label = "incidence", .unit = "deg", .min = 0.0, .max = 90.0},
                  .y = {.label = absolute ? "backscattering strength S_b" : "backscatter", .unit = "dB"},
                  .series = {},
                  .alt = "Backscatter of " + material + " against incidence, before and after the fit"};
  const GsabParameters<double>& fitted = fit.fit.parameters.Material(material).gsab;
  const GsabParameters<double>& initial = fit.initial.Material(material).gsab;
  const auto everywhere = [](double) { return true; };
  if (initial != fitted)
    chart.series.push_back(CurveOf("initial", initial, 1, SeriesStyle::kDashed, everywhere));
  const auto curve = std::ranges::find(fit.fit.report.curves, material, &calib::FittedCurve::material);
  const bool has_errors = curve != fit.fit.report.curves.end();
  if (const auto seen = fit.seen.find(material); seen != fit.seen.end()) {
    if (has_errors) {
      const auto determined = [&](double incidence_deg) {
        return incidence_deg >= seen->second.low_deg && incidence_deg <= seen->second.high_deg &&
               curve->determined[static_cast<std::size_t>(std::lround(incidence_deg))];
      };
      chart.series.push_back(CurveOf("fitted, determined", fitted, 0, SeriesStyle::kLine, determined));
    }
    chart.series.push_back(
        CurveOf(has_errors ? "fitted, not seen or pulled by its prior" : "no standard error", fitted, 0,
                SeriesStyle::kDashed, everywhere));
  }
  if (has_errors) chart.series.push_back(BandOf(*curve));
  if (has_errors && !curve->truth_db.empty()) {
    chart.series.push_back({.name = "truth",
                            .x = curve->incidence_deg,
                            .y = curve->truth_db,
                            .style = SeriesStyle::kDashed,
                            .colour = 2});
  }
  ClipBelow(chart.series);
  return chart;
}

void AddCorrelations(HtmlReport& report, const calib::FitReport& fit) {
  struct Pair {
    double correlation;
    std::string names;
  };
  std::vector<Pair> strong;
  for (Eigen::Index i = 0; i < fit.correlation.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double correlation = fit.correlation(i, j);
      if (!(std::abs(correlation) >= kStrongCorrelation)) continue;
      strong.push_back(
          {correlation, fmt::format("{} and {}", fit.correlation_names[static_cast<std::size_t>(j)],
                                    fit.correlation_names[static_cast<std::size_t>(i)])});
    }
  }
  if (strong.empty()) return;
  std::sort(strong.begin(), strong.end(),
            [](const Pair& a, const Pair& b) { return std::abs(a.correlation) > std::abs(b.correlation); });
  report.Paragraph(
      fmt::format("Values that trade off against each other ({} pair{} with a correlation of {} or "
                  "more; the whole matrix is in fit.json):",
                  strong.size(), strong.size() == 1 ? "" : "s", kStrongCorrelation));
  std::vector<std::string> items;
  for (const Pair& pair : strong) {
    if (items.size() == kCorrelationsShown) break;
    items.push_back(fmt::format("{}: {}", pair.names, FormatNumber(pair.correlation, 2)));
  }
  report.List(items);
}

std::string JudgedText(const workflow::RecordingFit& fit) {
  if (!fit.judged_on_held_out) {
    return "No frame was held out: the figures below are those of the fitted frames, and are too good.";
  }
  return fmt::format(
             "The fit used {} and is evaluated on the held-out {}. {} frames are compared with "
             "the expected image, the mean over {}, as grey levels are displayed.",
             NamedFrames(fit.fit.report.frames_used), NamedFrames(fit.fit.report.frames_held_out),
             RealCaption(fit.after.real_is_synthetic),
             fit.initial.model == EchoModel::kPaper ? "range and azimuth errors" : "speckle") +
         (fit.poses.empty()
              ? ""
              : " Poses were fitted, those of the held-out frames to these frames with all other parameters "
                "fixed; poses.json holds them all. The figures before the fit use the recorded poses.");
}

}  // namespace

std::string NamedFrames(const std::vector<int>& frames) {
  return fmt::format("frame{} {}", frames.size() == 1 ? "" : "s", FrameList(frames));
}

std::string FrameList(const std::vector<int>& frames) {
  if (frames.empty()) return "none";
  std::string text = fmt::format("{}", frames.front());
  for (std::size_t i = 1; i < frames.size(); ++i) {
    text += fmt::format("{}{}", i + 1 == frames.size() ? " and " : ", ", frames[i]);
  }
  return text;
}

std::vector<std::string> FitInWords(const workflow::RecordingFit& fit, const std::string& name) {
  const metrics::IntensityDomain domain = fit.after.options.intensity_domain;
  const metrics::ViewSummary& before = fit.before.aggregate.macro.polar;
  const metrics::ViewSummary& after = fit.after.aggregate.macro.polar;
  const std::size_t frames = fit.after.frames.size();
  return {
      fmt::format("On {} {} frame{}, the object regions of the {} and the simulated images have an IoU of {} "
                  "after {}, and had {} before.",
                  frames, fit.judged_on_held_out ? "held-out" : "fitted", frames == 1 ? "" : "s",
                  RealWord(fit.after.real_is_synthetic), FigureText(after.At("iou").value), name,
                  FigureText(before.At("iou").value)),
      fmt::format("Over {}, the grey values differ by {} of full scale after {}, and by {} before.",
                  DomainText(domain), FigureText(after.Over(domain).mean_absolute.value), name,
                  FigureText(before.Over(domain).mean_absolute.value))};
}

void AddFitOpening(HtmlReport& report, const workflow::RecordingFit& fit,
                   const std::vector<std::string>& sentences, const std::string& name) {
  std::vector<workflow::ComparedFrame> examples;
  for (const workflow::ComparedFrame& after : fit.frames_after) {
    if (std::ranges::any_of(fit.frames_before, [&](const workflow::ComparedFrame& before) {
          return before.metrics.index == after.metrics.index;
        }))
      examples.push_back(after);
  }
  if (examples.empty()) {
    report.Paragraph(fmt::format("{}", fmt::join(sentences, " ")));
  } else {
    AddOpening(report, MiddleFrame(examples, fit.after.options.intensity_domain), "after " + name,
               fit.after.real_is_synthetic, sentences);
  }
}

void AddFitWarnings(HtmlReport& report, const calib::FitReport& fit, const std::string& model) {
  const std::string title =
      model.empty() ? "This fit is doubtful" : fmt::format("The fit of the {} is doubtful", model);
  for (const std::string& sentence : fit.warnings)
    report.Callout(CalloutKind::kWarning, title, sentence + ".");
}

void AddFitKeyFigures(HtmlReport& report, const workflow::RecordingFit& fit) {
  std::vector<KeyFigure> figures;
  const auto add = [&](const std::string& label, const metrics::Statistic& before,
                       const metrics::Statistic& after) {
    const auto text = [](const metrics::Statistic& s) { return FormatNumber(s.value, 3); };
    figures.push_back({.label = label,
                       .value = text(after),
                       .unit = {},
                       .note = "was " + text(before) + " before the fit"});
  };
  const auto add_image = [&](const std::string& image, const metrics::MetricsReport& before,
                             const metrics::MetricsReport& after) {
    const metrics::IntensityDomain domain = after.options.intensity_domain;
    const metrics::ViewSummary& polar_before = before.aggregate.macro.polar;
    const metrics::ViewSummary& polar_after = after.aggregate.macro.polar;
    add(image + ": IoU of the object regions", polar_before.At("iou"), polar_after.At("iou"));
    add(image + ": intensity error, polar", polar_before.Over(domain).mean_absolute,
        polar_after.Over(domain).mean_absolute);
  };
  add_image("Expected image", fit.before, fit.after);
  if (fit.sample_before && fit.sample_after)
    add_image("Speckled sample", *fit.sample_before, *fit.sample_after);
  const auto& parameters = fit.fit.report.parameters;
  const auto fitted =
      std::count_if(parameters.begin(), parameters.end(), [](const calib::FittedParameter& p) {
        return p.status == calib::ParameterStatus::kFree || p.status == calib::ParameterStatus::kAtBound;
      });
  figures.push_back({.label = "Parameters fitted",
                     .value = fmt::format("{}", fitted),
                     .unit = {},
                     .note = fmt::format("on {} frames", fit.fit.report.frames_used.size())});
  report.KeyFigures(figures);
}

void AddFitComparison(HtmlReport& report, const workflow::RecordingFit& fit) {
  if (fit.judged_on_held_out) {
    report.Paragraph(JudgedText(fit));
  } else {
    report.Callout(CalloutKind::kLimit, "Not evaluated on held-out frames", JudgedText(fit));
  }
  AddBeforeAfterTable(report, fit.before, fit.after,
                      fit.judged_on_held_out
                          ? "Before and after the fit, on held-out frames: the expected image"
                          : "Before and after the fit, on the frames it used: the expected image");
  if (fit.sample_before && fit.sample_after) {
    AddBeforeAfterTable(report, *fit.sample_before, *fit.sample_after,
                        "As above, with a speckled sample in place of the expected image");
  }
  if (fit.fit.report.pings) report.Paragraph(calib::PingWorthText(*fit.fit.report.pings));
  report.Paragraph("The expected image after the fit:");
  report.List(SummaryInWords(fit.after));
  const bool synthetic = fit.after.real_is_synthetic;
  const ShownFrames shown = ShowFit(fit);
  if (!shown.examples.empty()) AddPictureLegend(report, RealWord(synthetic));
  if (!shown.viewer.frames.empty()) report.Add(shown.viewer);
  for (std::size_t i = 0; i < shown.examples.size(); ++i) {
    const std::string frame = fmt::format("Frame {}", shown.examples[i].metrics.index);
    AddFramePictures(report, fit.frames_before[i], frame + ", before the fit", synthetic);
    AddFramePictures(report, shown.examples[i], frame + ", after the fit", synthetic);
  }
}

void AddUnexplained(HtmlReport& report, const workflow::RecordingFit& fit) {
  if (fit.weights.empty() || !fit.fit.report.down_weighted_share) return;
  report.Subsection("Pixels that do not match the scene");
  report.Paragraph(
      fmt::format("{:.2f} % of the pixels used had a weight below one half in the fit, because their "
                  "neighbourhood is brighter or darker than speckle about the model allows.",
                  100.0 * *fit.fit.report.down_weighted_share));
  PictureRow row{.caption = "Weights of the pixels in the fit: black is full weight, brighter is less",
                 .pictures = {}};
  std::vector<int> dark;  // frames with an empty map
  for (std::size_t i = 0; i < fit.weights.size() && row.pictures.size() < kMapsShown; ++i) {
    Grid<float> missing = fit.weights[i];
    for (float& value : missing.values()) value = 1.0F - value;
    const auto less = std::count_if(missing.values().begin(), missing.values().end(),
                                    [](float value) { return value > 0.5F; });
    if (static_cast<double>(less) < kMinMapShare * static_cast<double>(missing.size())) {
      dark.push_back(fit.fit.report.frames_used[i]);
      continue;
    }
    row.pictures.push_back({.png = GreyPng(missing, 0.0, 1.0),
                            .caption = fmt::format("Frame {}", fit.fit.report.frames_used[i]),
                            .plot = SonarPlot{.axes = fit.axes,
                                              .view = SonarView::kPolar,
                                              .colours = SonarColours::kInferno,
                                              .bar = {"weight 1", "", "weight 0"}}});
  }
  if (!dark.empty()) {
    report.Paragraph(fmt::format(
        "No map is shown of frame{} {}: fewer than {:g} % of the pixels had a weight below one half.",
        dark.size() == 1 ? "" : "s", FrameList(dark), 100.0 * kMinMapShare));
  }
  if (!row.pictures.empty()) report.Add(row);
}

void AddFittedValues(HtmlReport& report, const workflow::RecordingFit& fit) {
  const calib::FitReport& result = fit.fit.report;
  std::vector<LineChart> charts;
  std::vector<std::string> unseen;
  for (const auto& [material, parameters] : fit.fit.parameters.materials) {
    if (fit.seen.contains(material)) {
      charts.push_back(CurveChart(material, fit));
    } else if (material != "default") {
      unseen.push_back(material);
    }
  }
  report.Subsection("Backscatter curves");
  if (!charts.empty()) {
    report.Add(charts,
               "Backscatter of each material before and after the fit. Solid: the frames used show the "
               "material at that incidence. Dashed: extrapolated. Band: 95 % confidence within this model.");
    if (const std::string level = calib::CurvesLevelText(result); !level.empty())
      report.Paragraph(level + ".");
  }
  for (const std::string& material : unseen)
    report.Paragraph("Not seen in the frames used: " + material + ".");

  report.Subsection("Parameters");
  for (const std::string& gauge : result.gauge) report.Callout(CalloutKind::kLimit, "Gauge", gauge + ".");
  if (!result.unidentifiable_directions.empty()) {
    report.Callout(CalloutKind::kLimit, "Not identifiable from these frames",
                   "The frames used do not determine these values separately. Each has its fixed value, the "
                   "value of its prior, or one of several values that fit equally well. It has no sigma.");
    report.List(result.unidentifiable_directions);
  }
  if (!result.other_poses.empty()) {
    report.Callout(CalloutKind::kLimit, "Poses with a double",
                   "Other poses fit these frames equally well. The pose nearer to the recorded one is "
                   "reported, and its sigmas hold only there.");
    report.List(result.other_poses);
  }
  report.Add(ValueTable(result));
  AddCorrelations(report, result);

  report.Subsection("Residuals and run");
  const char* unit = result.raw ? "of full scale" : "(deviance of speckle)";
  const calib::ResidualSummary residual = result.raw.value_or(result.whitened);
  report.Facts({{"Residual, mean", fmt::format("{:.5f} {}", residual.mean, unit)},
                {"Residual, spread", fmt::format("{:.5f} {}", residual.spread, unit)},
                {"Cost", fmt::format("{:.6g} before, {:.6g} after", result.cost_initial, result.cost_final)},
                {"Iterations", fmt::format("{}", result.iterations)},
                {"Ended", result.termination},
                {"Rays cast", fmt::format("{}", result.rays_cast)},
                {"Time", fmt::format("{:.1f} s to trace every frame once, {:.1f} s to fit", result.trace_s,
                                     result.solve_s)}});
}

}  // namespace sonarcal::report
