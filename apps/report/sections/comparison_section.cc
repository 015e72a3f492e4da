#include "apps/report/sections/comparison_section.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "apps/report/html/html_text.h"
#include "apps/report/pictures/sonar_picture.h"
#include "apps/report/sections/figure_words.h"
#include "apps/report/sections/segmentation_text.h"
#include "metrics/figures.h"

namespace sonarcal::report {
namespace {

constexpr std::size_t kMaxFrameRows = 200;

// Names of figures and their paths (metrics/figures.h).
using Rows = std::vector<std::pair<std::string, std::string>>;

Rows HeadFigures(metrics::IntensityDomain domain) {
  return {{"Ns/Nr", "ns_over_nr"},
          {"Na/Ns", "na_over_ns"},
          {"Na/Nr", "na_over_nr"},
          {"IoU", "iou"},
          {"Intensity error", metrics::IntensityErrorPath(domain)},
          {"Intensity error, whole image", metrics::IntensityErrorPath(metrics::IntensityDomain::kWhole)},
          {"Intensity error, overlap", metrics::IntensityErrorPath(metrics::IntensityDomain::kOverlap)},
          {"Intensity bias", fmt::format("intensity.{}.bias", ToString(domain))}};
}

std::string FloorText(const metrics::MetricsReport& metrics) {
  const metrics::NoiseFloor& floor = metrics.noise_floor;
  std::string text;
  if (floor.speckle) {
    text = fmt::format(
        "With single-look speckle on a {:g} dB display, a noise-free simulation of the right level differs "
        "by {:.3f} on average, and one with its own speckle by {:.3f}. Clipping or several looks lower these "
        "values. ",
        floor.speckle->span_db, floor.speckle->smooth_simulation, floor.speckle->speckled_simulation);
  } else {
    text =
        "The recording does not state how many dB its display spans, so the share of speckle is not known in "
        "these units. ";
  }
  const metrics::RealAgainstReal& measured = floor.real_against_real;
  if (measured.pairs.empty()) {
    if (!measured.absent_reason.empty())
      text += "Real against real: none, as " + measured.absent_reason + ".";
    return text;
  }
  const metrics::ViewSummary& view = measured.aggregate.macro.polar;
  return text +
         fmt::format(
             "Real frames of a static scene against each other ({} pair{}): IoU {}, intensity error {}.",
             measured.pairs.size(), measured.pairs.size() == 1 ? "" : "s", FigureText(view.At("iou").value),
             FigureText(view.Over(metrics.options.intensity_domain).mean_absolute.value));
}

std::vector<std::string> TableNotes(const metrics::MetricsReport& metrics) {
  std::vector<std::string> notes = {
      fmt::format("Compared: {} (real side) and {} (simulated side).", metrics.real, metrics.simulated)};
  if (!metrics.aggregate.no_interval_reason.empty()) {
    notes.push_back("No 95 % intervals: " + metrics.aggregate.no_interval_reason + ".");
  } else {
    notes.push_back(fmt::format("95 % intervals: frames resampled {} times, {}.", metrics::kBootstrapDraws,
                                metrics.aggregate.in_time
                                    ? "in blocks of consecutive ones, because they follow each other in time"
                                    : "taken as independent"));
  }
  const int left_out = metrics.aggregate.macro.polar.At("iou").frames_left_out;
  if (left_out > 0) {
    notes.push_back(fmt::format("{} of {} frames show no object in either image and have no ratios.",
                                left_out, metrics.aggregate.frame_count));
  }
  return notes;
}

Rows QuotedRows() {
  Rows rows;
  for (const std::string& path : metrics::QuotedFigures()) {
    const metrics::Figure& figure = metrics::Figures()[metrics::FigureIndex(path)];
    rows.emplace_back(LabelWithUnit(figure), path);
  }
  return rows;
}

// Table of one view: means over frames, pooled figures and the noise floor.
Table SummaryTable(const metrics::MetricsReport& metrics, const char* caption, const Rows& rows,
                   metrics::ViewSummary metrics::Aggregate::Views::*view) {
  const int frames = metrics.aggregate.frame_count;
  const metrics::ViewSummary& macro = metrics.aggregate.macro.*view;
  const metrics::ViewSummary& micro = metrics.aggregate.micro.*view;
  const metrics::Aggregate* floor = metrics.noise_floor.Beside();
  Table table{.caption = fmt::format("{}, {} frame{}", caption, frames, frames == 1 ? "" : "s"),
              .columns = {{"Figure"}, {"Mean of frames"}, {"95 %"}, {"Pixels pooled"}, {"95 %"}},
              .rows = {},
              .notes = TableNotes(metrics)};
  if (floor != nullptr) {
    table.columns.push_back({"Floor of the mean"});
    table.notes.push_back(FloorNote(metrics.noise_floor));
  }
  for (const auto& [label, path] : rows) {
    const metrics::Statistic& mean = macro.At(path);
    const metrics::Statistic& pooled = micro.At(path);
    TableRow row{
        {label, FigureText(mean.value), IntervalText(mean), FigureText(pooled.value), IntervalText(pooled)}};
    if (floor != nullptr) {
      row.cells.push_back(FigureText((floor->macro.*view).At(path).value));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table FrameTable(const metrics::MetricsReport& metrics) {
  const metrics::IntensityDomain domain = metrics.options.intensity_domain;
  Table table{.caption = "Frame by frame",
              .columns = {{"Frame"},
                          {"Ns", "pixels"},
                          {"Nr", "pixels"},
                          {"Na", "pixels"},
                          {"Ns/Nr"},
                          {"Na/Ns"},
                          {"Na/Nr"},
                          {"IoU"},
                          {"Error, polar"},
                          {"Error, fan"}},
              .rows = {},
              .notes = {"Counts and ratios are those of the polar image; the fan's are in metrics.json."}};
  // Shows evenly spread frames, including the first and the last, if all would make the page unreadable.
  const std::size_t frames = metrics.frames.size();
  const std::size_t shown = std::min(frames, kMaxFrameRows);
  if (shown < frames) {
    table.caption += fmt::format(": {} of {} frames, evenly spread", shown, frames);
    table.notes.emplace_back("All frames: per_frame.csv.");
  }
  for (std::size_t i = 0; i < shown; ++i) {
    const metrics::FrameMetrics& frame = metrics.frames[shown < 2 ? 0 : i * (frames - 1) / (shown - 1)];
    const metrics::Occupancy& polar = frame.polar.occupancy;
    table.rows.push_back(
        {{fmt::format("{}", frame.index), fmt::format("{}", polar.ns), fmt::format("{}", polar.nr),
          fmt::format("{}", polar.na), FigureText(polar.ns_over_nr()), FigureText(polar.na_over_ns()),
          FigureText(polar.na_over_nr()), FigureText(polar.iou()),
          FigureText(frame.polar.intensity.Over(domain).mean_absolute()),
          FigureText(frame.fan.intensity.Over(domain).mean_absolute())}});
  }
  const metrics::ViewSummary& mean = metrics.aggregate.macro.polar;
  table.rows.push_back({{"Mean", "", "", "", FigureText(mean.At("ns_over_nr").value),
                         FigureText(mean.At("na_over_ns").value), FigureText(mean.At("na_over_nr").value),
                         FigureText(mean.At("iou").value), FigureText(mean.Over(domain).mean_absolute.value),
                         FigureText(metrics.aggregate.macro.fan.Over(domain).mean_absolute.value)},
                        RowStyle::kStrong});
  return table;
}

const char* KindOf(SonarView view) {
  return view == SonarView::kPolar ? "polar" : "fan";
}

// Recorded (or synthetic), simulated and overlaid.
PictureRow RowOf(const workflow::ComparedFrame& frame, SonarView view, const std::string& caption,
                 bool real_is_synthetic) {
  const std::string real = RealCaption(real_is_synthetic);
  const auto alt = [&](const std::string& what) {
    return fmt::format("{}, {} view of frame {}", what, KindOf(view), frame.metrics.index);
  };
  return {.caption = caption,
          .pictures = {SonarPicture(frame.real, view, real, alt(real + " image")),
                       SonarPicture(frame.simulated, view, "Simulated", alt("Simulated image")),
                       OverlayPicture(frame.real, frame.simulated, view, RealWord(real_is_synthetic),
                                      alt("Both images superimposed"))},
          .columns = 4};
}

}  // namespace

void AddSyntheticCallout(HtmlReport& report, bool real_is_synthetic, const std::string& real_name) {
  if (real_is_synthetic) {
    report.Callout(CalloutKind::kSynthetic, "Both sides are synthetic",
                   fmt::format("No sonar recorded {}: it was made by a simulation and stands in for a real "
                               "recording. Where this page says real, it means that side.",
                               real_name));
  } else {
    report.Callout(
        CalloutKind::kSynthetic, "The simulated side is synthetic",
        fmt::format("{} counts as recorded by a sonar, because it does not state otherwise.", real_name));
  }
}

void AddSyntheticRecordingCallout(HtmlReport& report, bool is_synthetic, const std::string& name) {
  if (!is_synthetic) return;
  report.Callout(CalloutKind::kSynthetic, "The recording is synthetic",
                 fmt::format("No sonar recorded {}: it was made by a simulation.", name));
}

void AddKeyFigures(HtmlReport& report, const metrics::MetricsReport& metrics) {
  const metrics::Aggregate::Views& macro = metrics.aggregate.macro;
  const metrics::IntensityDomain domain = metrics.options.intensity_domain;
  const auto interval = [](const metrics::Statistic& s) {
    return s.ci ? "95 %: " + IntervalText(s) : std::string();
  };
  const auto figure = [&](const char* label, const metrics::Statistic& s) {
    return KeyFigure{.label = label, .value = FigureText(s.value), .unit = {}, .note = interval(s)};
  };
  report.KeyFigures({{.label = "Frames", .value = fmt::format("{}", metrics.aggregate.frame_count)},
                     figure("IoU of the object regions", macro.polar.At("iou")),
                     figure("Intensity error, polar", macro.polar.Over(domain).mean_absolute),
                     figure("Intensity error, fan", macro.fan.Over(domain).mean_absolute)});
}

void AddMetricTables(HtmlReport& report, const metrics::MetricsReport& metrics) {
  using Views = metrics::Aggregate::Views;
  const Rows head = HeadFigures(metrics.options.intensity_domain);
  report.Add(SummaryTable(metrics, "Agreement of the polar images", head, &Views::polar));
  report.Add(SummaryTable(metrics, "Agreement of the fan images", head, &Views::fan));
  report.Add(SummaryTable(metrics, "Figures that others quote, polar images", QuotedRows(), &Views::polar));
  report.Add(FrameTable(metrics));
  for (const std::string& note : metrics.notes) report.Callout(CalloutKind::kNote, "Note", note);
}

void AddBeforeAfterTable(HtmlReport& report, const metrics::MetricsReport& before,
                         const metrics::MetricsReport& after, const std::string& caption) {
  Table table{
      .caption = caption,
      .columns =
          {{"Figure"}, {"Polar, before"}, {"Polar, after"}, {"95 %, after"}, {"Fan, before"}, {"Fan, after"}},
      .rows = {},
      .notes = TableNotes(after)};
  table.notes.insert(table.notes.begin(), "Means over frames.");
  for (const auto& [label, path] : HeadFigures(after.options.intensity_domain)) {
    const metrics::Statistic& polar = after.aggregate.macro.polar.At(path);
    table.rows.push_back(
        {{label, FigureText(before.aggregate.macro.polar.At(path).value), FigureText(polar.value),
          IntervalText(polar), FigureText(before.aggregate.macro.fan.At(path).value),
          FigureText(after.aggregate.macro.fan.At(path).value)}});
  }
  report.Add(table);
}

void AddPictureLegend(HtmlReport& report, const std::string& real) {
  report.ParagraphOnce(fmt::format(
      "In an overlay blue is brighter in the {0} image and orange brighter in the simulated one; where the "
      "two agree it is grey. Object regions are blue where only the {0} image has an object, orange where "
      "only the simulated one has, and white where both have. Polar pictures run from the nearest range at "
      "the top to the farthest, fans from the sonar upwards.",
      real));
}

void AddOpening(HtmlReport& report, const workflow::ComparedFrame& frame, const std::string& caption,
                bool real_is_synthetic, const std::vector<std::string>& sentences) {
  const std::string what = fmt::format("Frame {}, {}, fan view.", frame.metrics.index, caption);
  PictureRow row = RowOf(frame, SonarView::kFan, what, real_is_synthetic);
  row.columns = 3;
  report.Add(row);
  report.Paragraph(fmt::format("{}", fmt::join(sentences, " ")));
}

void AddFramePictures(HtmlReport& report, const workflow::ComparedFrame& frame, const std::string& caption,
                      bool real_is_synthetic) {
  const Grid<std::uint8_t> regions = ObjectRegions(frame.metrics);
  const bool any_object = std::ranges::any_of(regions.values(), [](std::uint8_t of) { return of != 0; });
  for (const SonarView view : {SonarView::kPolar, SonarView::kFan}) {
    const std::string kind = KindOf(view);
    PictureRow row = RowOf(frame, view, fmt::format("{}, {} view.", caption, kind), real_is_synthetic);
    if (any_object) {
      row.pictures.push_back(RegionsPicture(
          frame.real.axes, regions, view,
          fmt::format("Object regions of both images, {} view of frame {}", kind, frame.metrics.index)));
      row.legend = {{"#0072b2", RealWord(real_is_synthetic) + " only"},
                    {"#e69f00", "simulated only"},
                    {"#ebebeb", "both"}};
    } else {
      row.caption += " No object is found in either image.";
    }
    report.Add(row);
  }
}

void AddMetricDefinitions(HtmlReport& report, const metrics::MetricsReport& metrics) {
  report.Section("What the numbers mean");
  report.Facts(
      {{"Ns, Nr, Na", "pixels of the object region in the simulated image, in the real one, in both"},
       {"Ns/Nr, Na/Ns, Na/Nr", "1 where the regions agree; the pooled ones satisfy Na/Nr = (Na/Ns)(Ns/Nr)"},
       {"IoU", "Na / (Ns + Nr - Na): shared area over joint area, 1 where the regions agree"},
       {"Intensity error", "mean of |simulated - real| / full scale over " +
                               DomainText(metrics.options.intensity_domain) + "; 0 is best"},
       {"Intensity bias",
        "mean of (simulated - real) / full scale there; positive: the simulation is brighter"},
       {"Mean of frames", "each frame weighs the same; frames without a value are left out"},
       {"Pixels pooled", "counts and sums of all frames added up first; each pixel weighs the same"}});
  report.Subsection("How the object is found");
  report.Paragraph(DetectorText(metrics.options, metrics.real_is_synthetic));
  report.Subsection("What no simulator can beat");
  report.Paragraph(FloorText(metrics));
}

}  // namespace sonarcal::report
