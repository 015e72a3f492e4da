#include "apps/report/detection/transfer_section.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/report/html/html_text.h"
#include "apps/report/pictures/sonar_picture.h"
#include "apps/report/sections/figure_words.h"

namespace sonarcal::report {
namespace {

using Json = nlohmann::ordered_json;
using Figure = metrics::TransferFigure metrics::DetectorFigures::*;

constexpr const char* kOnTraining = "Trained on --train";
constexpr const char* kOnTest = "Trained on other --test frames";

constexpr std::pair<const char*, Figure> kFigures[] = {
    {"Average precision", &metrics::DetectorFigures::average_precision},
    {"IoU", &metrics::DetectorFigures::iou},
    {"Precision", &metrics::DetectorFigures::precision},
    {"Recall", &metrics::DetectorFigures::recall}};

Json FigureJson(const metrics::TransferFigure& figure) {
  return {{"value", figure.value ? Json(*figure.value) : Json(nullptr)},
          {"ci", figure.ci ? Json::array({figure.ci->lo, figure.ci->hi}) : Json(nullptr)}};
}

Json FiguresJson(const metrics::DetectorFigures& figures) {
  return {{"average_precision", FigureJson(figures.average_precision)},
          {"iou", FigureJson(figures.iou)},
          {"precision", FigureJson(figures.precision)},
          {"recall", FigureJson(figures.recall)}};
}

Json CurveJson(const metrics::PrecisionRecall& curve) {
  return {{"recall", curve.recall}, {"precision", curve.precision}};
}

std::string WithInterval(const metrics::TransferFigure& figure) {
  if (!figure.value) return "none";
  if (!figure.ci) return fmt::format("{:.3f}", *figure.value);
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", *figure.value, figure.ci->lo, figure.ci->hi);
}

std::string IntervalText(const metrics::TransferFigure& figure) {
  if (!figure.ci) return "–";
  return fmt::format("{} to {}", FormatNumber(figure.ci->lo, 3), FormatNumber(figure.ci->hi, 3));
}

std::string ValueText(const metrics::TransferFigure& figure) {
  return FormatNumber(figure.value, 3);
}

// Sentence about the difference of average precision.
std::string Verdict(const metrics::TransferFigure& difference) {
  if (!difference.ci) return "The test frames are too few for an interval of the difference.";
  if (difference.ci->hi < 0.0)
    return "The frames of --train train this detector worse than other test frames do: the 95 % interval of "
           "the difference in average precision is below 0.";
  if (difference.ci->lo > 0.0)
    return "The frames of --train train this detector better than other test frames do: the 95 % interval of "
           "the difference in average precision is above 0.";
  return "No difference is significant between training on --train and on other test frames: the 95 % "
         "interval of the difference in average precision contains 0.";
}

void AddCallout(HtmlReport& report, const workflow::RecordingTransfer& result) {
  const std::string training = fmt::format("{}", fmt::join(result.training, ", "));
  const std::string test = fmt::format("{}", fmt::join(result.test, ", "));
  if (result.test_is_synthetic) {
    report.Callout(
        CalloutKind::kSynthetic, "Test frames are synthetic",
        fmt::format("No sonar recorded all frames of {}: a simulation made them, and they stand in "
                    "for recorded ones.",
                    test));
  } else {
    report.Callout(
        CalloutKind::kSynthetic,
        result.training_is_synthetic ? "Training frames are synthetic" : "Where the frames come from",
        fmt::format("{} counts as recorded by a sonar, because it does not state otherwise. The "
                    "detector is trained on {}.",
                    test, training));
  }
}

void AddFigures(HtmlReport& report, const metrics::Transfer& transfer) {
  const auto key = [](const char* label, const metrics::TransferFigure& figure) {
    return KeyFigure{.label = label,
                     .value = ValueText(figure),
                     .unit = {},
                     .note = figure.ci ? "95 %: " + IntervalText(figure) : std::string()};
  };
  report.KeyFigures(
      {key("Average precision, trained on --train", transfer.simulated.average_precision),
       key("Average precision, trained on other --test frames", transfer.reference.average_precision),
       key("Difference", transfer.difference.average_precision),
       {.label = "Average precision of guessing", .value = FormatNumber(transfer.object_share, 3)}});
  report.Paragraph(Verdict(transfer.difference.average_precision));
  report.Section("Figures");
  Table table{
      .caption = fmt::format("Pixels of {} test frames pooled", transfer.test_frames),
      .columns = {{"Figure"}, {kOnTraining}, {"95 %"}, {kOnTest}, {"95 %"}, {"Difference"}, {"95 %"}},
      .rows = {},
      .notes = {fmt::format("{} training frames. {} blocks of consecutive test frames: the reference "
                            "of a block is trained on the others.",
                            transfer.training_frames, transfer.blocks),
                "IoU, precision and recall: at the score of the highest IoU on the frames of training.",
                "Intervals: percentile bootstrap over test frames, the same frames for both detectors. "
                "They do not contain the variation of training."}};
  for (const auto& [label, figure] : kFigures) {
    const metrics::TransferFigure& on_training = transfer.simulated.*figure;
    const metrics::TransferFigure& on_test = transfer.reference.*figure;
    const metrics::TransferFigure& difference = transfer.difference.*figure;
    table.rows.push_back({{label, ValueText(on_training), IntervalText(on_training), ValueText(on_test),
                           IntervalText(on_test), ValueText(difference), IntervalText(difference)}});
  }
  report.Add(table);
}

void AddCurves(HtmlReport& report, const metrics::Transfer& transfer) {
  report.Section("Precision and recall");
  LineChart chart{.title = "Precision-recall curves",
                  .x = {.label = "recall", .unit = {}, .min = 0.0, .max = 1.0},
                  .y = {.label = "precision", .unit = {}, .min = 0.0, .max = 1.0},
                  .series = {},
                  .alt = "Precision over recall of both detectors, and of guessing"};
  const auto add = [&](const char* name, const metrics::PrecisionRecall& curve) {
    chart.series.push_back({.name = name, .x = curve.recall, .y = curve.precision});
  };
  add("trained on --train", transfer.simulated_curve);
  add("trained on other --test frames", transfer.reference_curve);
  chart.series.push_back({.name = "guessing",
                          .x = {0.0, 1.0},
                          .y = {transfer.object_share, transfer.object_share},
                          .style = SeriesStyle::kDashed});
  report.Add({chart}, "Precision over recall at falling scores, pixels of all test frames pooled");
}

// Regions of a detector: 1 labelled only, 2 detected only, 3 both.
Picture DetectedPicture(const workflow::TestedFrame& frame, const Mask& detected, const char* caption) {
  Grid<std::uint8_t> regions(detected.rows(), detected.cols());
  std::ranges::transform(frame.object.values(), detected.values(), regions.values().begin(),
                         [](std::uint8_t labelled, std::uint8_t found) {
                           return std::uint8_t((labelled != 0 ? 1 : 0) + (found != 0 ? 2 : 0));
                         });
  Picture picture =
      RegionsPicture(frame.image.axes, regions, SonarView::kFan,
                     fmt::format("{}: labelled and detected pixels of frame {}", caption, frame.frame));
  picture.caption = caption;
  return picture;
}

void AddPictures(HtmlReport& report, const workflow::RecordingTransfer& result) {
  if (result.shown.empty()) return;
  report.Section("Test frames");
  report.Paragraph(fmt::format("{} test frame{} with an object, evenly spread.", result.shown.size(),
                               result.shown.size() == 1 ? "" : "s"));
  const std::string real = RealCaption(result.test_is_synthetic);
  for (const workflow::TestedFrame& frame : result.shown) {
    report.Add(PictureRow{
        .caption =
            fmt::format("Frame {} of {}, fan view. IoU {} trained on --train, {} on other --test frames.",
                        frame.frame, frame.recording, FigureText(frame.found.of_simulated.iou()),
                        FigureText(frame.found.of_reference.iou())),
        .pictures = {SonarPicture(frame.image, SonarView::kFan, real,
                                  fmt::format("{} image of test frame {}", real, frame.frame)),
                     DetectedPicture(frame, frame.found.by_simulated, kOnTraining),
                     DetectedPicture(frame, frame.found.by_reference, kOnTest)},
        .columns = 3,
        .legend = {{"#0072b2", "labelled only"}, {"#e69f00", "detected only"}, {"#ebebeb", "both"}}});
  }
}

}  // namespace

void AddTransfer(HtmlReport& report, const workflow::RecordingTransfer& result) {
  AddCallout(report, result);
  AddFigures(report, result.transfer);
  AddCurves(report, result.transfer);
  AddPictures(report, result);
}

std::string TransferText(const workflow::RecordingTransfer& result) {
  const metrics::Transfer& transfer = result.transfer;
  std::string text =
      fmt::format("trained on {} ({} frames), tested on {} ({} frames)\n", fmt::join(result.training, ", "),
                  transfer.training_frames, fmt::join(result.test, ", "), transfer.test_frames);
  constexpr auto kRow = "  {:<20}{:<24}{:<24}{}\n";
  text += fmt::format(kRow, "", "trained on --train", "on other --test frames", "difference");
  const auto add = [&](const char* label, Figure figure) {
    text += fmt::format(kRow, label, WithInterval(transfer.simulated.*figure),
                        WithInterval(transfer.reference.*figure), WithInterval(transfer.difference.*figure));
  };
  add("average precision", &metrics::DetectorFigures::average_precision);
  add("IoU", &metrics::DetectorFigures::iou);
  add("precision", &metrics::DetectorFigures::precision);
  add("recall", &metrics::DetectorFigures::recall);
  return text + fmt::format(
                    "  guessing has an average precision of {:.3f}; in brackets: 95 % interval over "
                    "test frames\n",
                    transfer.object_share);
}

Json TransferJson(const workflow::RecordingTransfer& result) {
  const metrics::Transfer& transfer = result.transfer;
  return {{"format", "sonar-transfer/1"},
          {"training", result.training},
          {"test", result.test},
          {"training_frames", transfer.training_frames},
          {"test_frames", transfer.test_frames},
          {"blocks", transfer.blocks},
          {"object_share", transfer.object_share},
          {"trained_on_training", FiguresJson(transfer.simulated)},
          {"trained_on_test_blocks", FiguresJson(transfer.reference)},
          {"difference", FiguresJson(transfer.difference)},
          {"curves",
           {{"trained_on_training", CurveJson(transfer.simulated_curve)},
            {"trained_on_test_blocks", CurveJson(transfer.reference_curve)}}}};
}

}  // namespace sonarcal::report
