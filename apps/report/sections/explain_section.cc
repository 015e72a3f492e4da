#include "apps/report/sections/explain_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/report/html/html_text.h"
#include "apps/report/pictures/cause_pictures.h"
#include "apps/report/pictures/sonar_picture.h"
#include "apps/report/sections/fit_section.h"
#include "data_io/images/image_io.h"

namespace sonarcal::report {
namespace {

using Json = nlohmann::ordered_json;

Json NumberOrNull(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

std::string Text(const std::optional<double>& value, int decimals) {
  return value ? FormatNumber(*value, decimals) : "none";
}

std::string_view WhatOf(calib::ExplainedPart part) {
  switch (part) {
    case calib::ExplainedPart::kStart:
      return "one curve for all, beams as wide as their spacing, a pulse of one bin, a black background";
    case calib::ExplainedPart::kResponse:
      return "the beam pattern in azimuth, and the pulse";
    case calib::ExplainedPart::kElevation:
      return "the beam pattern in elevation, with side lobes";
    case calib::ExplainedPart::kNoise:
      return "a noise floor";
    case calib::ExplainedPart::kMaterials:
      return "a backscatter curve for each material";
    case calib::ExplainedPart::kGhosts:
      return "echoes by way of mirrors, with fitted losses";
    case calib::ExplainedPart::kSpeckle:
      return "grey values vary as speckle does";
    case calib::ExplainedPart::kPoses:
      return "the pose of every frame";
  }
  return "";
}

WaterfallMood MoodOf(calib::Verdict verdict) {
  switch (verdict) {
    case calib::Verdict::kStart:
      return WaterfallMood::kStart;
    case calib::Verdict::kSignificant:
      return WaterfallMood::kBetter;
    case calib::Verdict::kNotSignificant:
      return WaterfallMood::kSame;
    case calib::Verdict::kWorse:
      return WaterfallMood::kWorse;
    case calib::Verdict::kContradicted:
      return WaterfallMood::kSame;
  }
  return WaterfallMood::kSame;
}

// Names with a share, in descending order of share.
std::vector<std::pair<double, std::string>> Shares(const workflow::ExplainedRecording& explained) {
  std::vector<std::pair<double, std::string>> shares;
  for (std::size_t name = 1; name < explained.cause_names.size(); ++name) {
    if (explained.cause_shares[name] > 0.0)
      shares.emplace_back(explained.cause_shares[name], explained.cause_names[name]);
  }
  std::stable_sort(shares.begin(), shares.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  return shares;
}

Table StepTable(const workflow::ExplainedRecording& explained, const workflow::JudgedSteps& judged,
                const std::string& by, const std::string& real) {
  Table table{.caption = "Each part added to those above it, fitted again, and evaluated " + by,
              .columns = {{"Added"},
                          {"Intensity error", "of full scale"},
                          {"Median image", "of full scale"},
                          {"About the object", "of full scale"},
                          {"IoU"},
                          {"Ns/Nr"},
                          {"Gain, held out", "nats a pixel"},
                          {"AIC, BIC", "change"},
                          {"Fitted", "values"},
                          {"Verdict", {}, false}},
              .rows = {}};
  const std::vector<calib::ExplainedStep>& steps = explained.explanation.steps;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const calib::ExplainedStep& step = steps[i];
    const workflow::StepFigures& figures = judged.figures[i];
    const calib::LikelihoodDifference& gain = judged.gain[i];
    const bool first = i == 0;
    table.rows.push_back(
        {.cells = {
             std::string(TitleOf(step.part)), Text(figures.intensity_error, 4),
             Text(judged.median_error[i], 4), Text(figures.about_error, 4), Text(figures.iou, 3),
             Text(figures.ns_over_nr, 3),
             first ? "–" : fmt::format("{} ± {}", FormatNumber(gain.mean, 4), FormatNumber(gain.sigma, 4)),
             first
                 ? "–"
                 : fmt::format("{}, {}", FormatNumber(step.aic_change, 0), FormatNumber(step.bic_change, 0)),
             fmt::format("{}", step.determined), std::string(ToString(judged.verdict[i]))}});
  }
  table.notes.push_back(fmt::format(
      "Significant: the held-out frames are more likely by more than two standard errors, BIC falls, and the "
      "error of the median image does not rise by more than two standard errors. If likelihood and error "
      "disagree, the part is contradicted by the error. Both criteria count {:.0f} independent cells in the "
      "frames used, not {:.0f} pixels: speckle is correlated over {:.1f} of them.",
      explained.explanation.pixels_used / explained.explanation.pixels_per_cell,
      explained.explanation.pixels_used, explained.explanation.pixels_per_cell));
  table.notes.push_back(fmt::format(
      "Intensity error: mean absolute difference of grey values over the whole polar image. Median image: "
      "this error for the median of each pixel's law from speckle on, which makes it smallest. About the "
      "object: the error within {} range bins and {} beams of the object in the {} image. Before "
      "speckle is added, a constant is subtracted, and occupancy is that of the expected image. From there "
      "on it is that of a speckled sample, and means little if the segmentation does not find an object. "
      "Gain and criteria of materials and ghosts are those of the law of speckle. "
      "Fitted values: those of all steps so far that the data determine.",
      workflow::kAboutBins, workflow::kAboutBeams, real));
  return table;
}

// Makes texts such as "frame 2" or "frames 2 and 6".
Waterfall WaterfallOf(const workflow::ExplainedRecording& explained, const workflow::JudgedSteps& judged,
                      std::optional<double> workflow::StepFigures::*error_of, const std::string& title) {
  const std::vector<calib::ExplainedStep>& steps = explained.explanation.steps;
  const bool whole = error_of == &workflow::StepFigures::intensity_error;
  Waterfall waterfall{.title = title,
                      .unit = "mean absolute error of grey values, of full scale",
                      .decimals = 4,
                      .floor = whole ? judged.floor_error : judged.about_floor_error,
                      .floor_label = "speckle alone:"};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double error = (judged.figures[i].*error_of).value_or(0.0);
    waterfall.rows.push_back({.label = std::string(TitleOf(steps[i].part)),
                              .value = error,
                              .mood = MoodOf(judged.verdict[i]),
                              .word = i == 0 ? std::string() : std::string(ToString(judged.verdict[i]))});
    waterfall.alt += fmt::format("{}{} {:.4f}", i == 0 ? "" : ", ", TitleOf(steps[i].part), error);
  }
  return waterfall;
}

// Evaluations: each frame alone, or all together.
std::vector<workflow::JudgedSteps> Judges(const workflow::ExplainedRecording& explained,
                                          const ExplanationPresentation& presentation) {
  if (presentation.apart) return explained.by_frame;
  return {explained.judged};
}

Json FiguresJson(const workflow::JudgedSteps& judged, std::size_t i) {
  const workflow::StepFigures& figures = judged.figures[i];
  const auto change = [&](double value) { return i == 0 ? Json(nullptr) : Json(value); };
  return {{"verdict", ToString(judged.verdict[i])},
          {"intensity_error", NumberOrNull(figures.intensity_error)},
          {"median_image_error", judged.median_error[i]},
          {"median_image_error_change", change(judged.error_change[i].mean)},
          {"median_image_error_change_sigma", change(judged.error_change[i].sigma)},
          {"about_object_error", NumberOrNull(figures.about_error)},
          {"union_error", NumberOrNull(figures.union_error)},
          {"overlap_error", NumberOrNull(figures.overlap_error)},
          {"iou", NumberOrNull(figures.iou)},
          {"ns_over_nr", NumberOrNull(figures.ns_over_nr)},
          {"held_out_nats_per_pixel", judged.nats_per_pixel[i]},
          {"gain_nats_per_pixel", change(judged.gain[i].mean)},
          {"gain_sigma", change(judged.gain[i].sigma)}};
}

std::string TextOf(const workflow::ExplainedRecording& explained, const workflow::JudgedSteps& judged) {
  std::string text =
      fmt::format("  {:<20}  {:>9}  {:>6}  {:>6}  {:>6}  {:>6}  {:>19}  {:>9}  {}\n", "part added",
                  "intensity", "median", "about", "IoU", "Ns/Nr", "gain, nats a pixel", "BIC", "verdict");
  const std::vector<calib::ExplainedStep>& steps = explained.explanation.steps;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const workflow::StepFigures& figures = judged.figures[i];
    const std::string gain =
        i == 0 ? std::string("-")
               : fmt::format("{:+.4f} +- {:.4f}", judged.gain[i].mean, judged.gain[i].sigma);
    const std::string bic = i == 0 ? std::string("-") : fmt::format("{:+.0f}", steps[i].bic_change);
    text += fmt::format("  {:<20}  {:>9}  {:>6}  {:>6}  {:>6}  {:>6}  {:>19}  {:>9}  {}\n",
                        TitleOf(steps[i].part), Text(figures.intensity_error, 4),
                        Text(judged.median_error[i], 4), Text(figures.about_error, 4), Text(figures.iou, 3),
                        Text(figures.ns_over_nr, 3), gain, bic, i == 0 ? "" : ToString(judged.verdict[i]));
  }
  if (judged.floor_error) {
    text += fmt::format("  {:<20}  {:>9}  {:>6}  {:>6}  of the last model's own samples\n", "speckle alone",
                        Text(judged.floor_error, 4), "", Text(judged.about_floor_error, 4));
  }
  return text;
}

// Nullopt if likelihood and error of the held-out frames agree.
std::optional<std::string> ContradictionOf(const workflow::ExplainedRecording& explained,
                                           const workflow::JudgedSteps& judged, std::size_t i) {
  if (judged.verdict[i] != calib::Verdict::kContradicted) return std::nullopt;
  const bool likelier = judged.gain[i].mean > 0.0;
  return fmt::format(
      "'{}' makes {} {} likely ({:+.4f} +- {:.4f} nats a pixel), but the error of the median image {} by "
      "{:.4f} +- {:.4f} of full scale to {:.4f}",
      TitleOf(explained.explanation.steps[i].part), NamedFrames(judged.frames), likelier ? "more" : "less",
      judged.gain[i].mean, judged.gain[i].sigma, likelier ? "rises" : "falls",
      std::abs(judged.error_change[i].mean), judged.error_change[i].sigma, judged.median_error[i]);
}

}  // namespace

std::vector<std::string> WarningsOf(const workflow::ExplainedRecording& explained,
                                    const ExplanationPresentation& presentation) {
  std::vector<std::string> warnings = presentation.warnings;
  const std::vector<std::string>& ends = explained.explanation.warnings;
  warnings.insert(warnings.end(), ends.begin(), ends.end());
  for (const workflow::JudgedSteps& judged : Judges(explained, presentation)) {
    for (std::size_t i = 0; i < judged.verdict.size(); ++i) {
      if (const auto sentence = ContradictionOf(explained, judged, i)) warnings.push_back(*sentence);
    }
  }
  return warnings;
}

std::string_view TitleOf(calib::ExplainedPart part) {
  switch (part) {
    case calib::ExplainedPart::kStart:
      return "plain echoes";
    case calib::ExplainedPart::kResponse:
      return "+ beam and pulse";
    case calib::ExplainedPart::kElevation:
      return "+ elevation pattern";
    case calib::ExplainedPart::kNoise:
      return "+ noise floor";
    case calib::ExplainedPart::kMaterials:
      return "+ materials";
    case calib::ExplainedPart::kGhosts:
      return "+ ghosts";
    case calib::ExplainedPart::kSpeckle:
      return "+ speckle";
    case calib::ExplainedPart::kPoses:
      return "+ poses";
  }
  return "";
}

std::string CauseSentence(const workflow::ExplainedRecording& explained) {
  constexpr double kFew = 0.005;
  std::string sentence;
  double rest = 0.0;
  for (const auto& [share, name] : Shares(explained)) {
    if (share < kFew) {
      rest += share;
      continue;
    }
    sentence += fmt::format("{}{:.0f} % {}", sentence.empty() ? "" : ", ", 100.0 * share, name);
  }
  if (sentence.empty()) return "no cell is bright";
  if (rest > 0.0) sentence += fmt::format(", {:.1f} % others", 100.0 * rest);
  return "of the bright cells: " + sentence;
}

void AddWaterfall(HtmlReport& report, const workflow::ExplainedRecording& explained,
                  const ExplanationPresentation& presentation) {
  report.Section("What each part is worth");
  for (const std::string& sentence : WarningsOf(explained, presentation))
    report.Callout(CalloutKind::kWarning, "Doubtful", sentence + ".");
  if (!presentation.caveats.empty()) {
    report.Callout(CalloutKind::kLimit, "What to know", "Assumptions, and limits of the figures.");
    report.List(presentation.caveats);
  }
  const std::string real = RealWord(presentation.synthetic);
  for (const workflow::JudgedSteps& judged : Judges(explained, presentation)) {
    const std::string by = "by " + NamedFrames(judged.frames) + ", which no fit saw";
    if (presentation.apart) report.Subsection("Judged by " + NamedFrames(judged.frames));
    std::string of = presentation.title.empty() ? std::string() : ": " + presentation.title;
    if (presentation.apart) of += ", by " + NamedFrames(judged.frames);
    const std::string known = presentation.title.empty() ? std::string() : " (" + presentation.title + ")";
    report.Add(WaterfallOf(explained, judged, &workflow::StepFigures::intensity_error,
                           "Error that remains after each part is added" + of),
               fmt::format("Evaluated {}{}. Blue: the remaining error. Pale green: error that a part "
                           "removes. Red: error that it adds. Dashed line: difference between the last model "
                           "and its own speckled samples, from speckle and noise.",
                           by, known));
    if (presentation.about && judged.figures.back().about_error) {
      report.Add(
          WaterfallOf(explained, judged, &workflow::StepFigures::about_error,
                      "Error that remains about the object" + of),
          fmt::format("Evaluated {}{}, within {} range bins and {} beams of the object in the {} image.", by,
                      known, workflow::kAboutBins, workflow::kAboutBeams, real));
    }
    report.Add(StepTable(explained, judged, by, real));
  }
  std::vector<std::string> parts;
  for (const calib::ExplainedStep& step : explained.explanation.steps)
    parts.push_back(fmt::format("{}: {}", TitleOf(step.part), WhatOf(step.part)));
  report.List(parts);
  if (!explained.explanation.left_out.empty()) {
    report.Callout(CalloutKind::kLimit, "Left out", "These parts were not added.");
    report.List(explained.explanation.left_out);
  }
}

void AddCauses(HtmlReport& report, const workflow::ExplainedRecording& explained,
               const ExplanationPresentation& presentation) {
  report.Section("What the bright cells come from");
  std::string sentence = CauseSentence(explained);
  if (!sentence.empty()) sentence.front() = static_cast<char>(std::toupper(sentence.front()));
  report.Paragraph(sentence + ".");
  const std::string real = RealWord(presentation.synthetic);
  PictureRow row{
      .caption = (presentation.title.empty() ? std::string() : presentation.title + ". ") +
                 RealCaption(presentation.synthetic) +
                 " (left) and what each bright cell comes from by the last model (right); "
                 "nearest range at the top. A cell is bright where the " +
                 real +
                 " power about it is twice the noise floor, and not explained where it is three times what "
                 "is expected.",
      .pictures = {},
      .columns = 2,
      .legend = CauseLegend(explained.maps, explained.cause_names)};
  constexpr std::size_t kMax = 4;
  for (std::size_t i = 0; i < std::min(kMax, explained.maps.size()); ++i) {
    const workflow::CauseMap& map = explained.maps[i];
    row.pictures.push_back(
        SonarPicture(map.recorded, SonarView::kPolar, fmt::format("Frame {}, {}", map.index, real), {}));
    row.pictures.push_back(
        {.png = data_io::EncodePng(CausePicture(map.cause)),
         .caption = fmt::format("Frame {}, causes", map.index),
         .plot = SonarPlot{
             .axes = map.recorded.axes, .view = SonarView::kPolar, .colours = SonarColours::kCategories}});
  }
  report.Add(row);
  Table table{.caption = "Shares of the bright cells of the frames held out",
              .columns = {{"Cause"}, {"Share", "%"}},
              .rows = {}};
  for (const auto& [share, name] : Shares(explained))
    table.rows.push_back({{name, FormatNumber(100.0 * share, 1)}});
  if (!table.rows.empty()) report.Add(table);
}

Json ExplanationJson(const workflow::ExplainedRecording& explained,
                     const ExplanationPresentation& presentation) {
  const calib::Explanation& of = explained.explanation;
  Json steps = Json::array();
  for (std::size_t i = 0; i < of.steps.size(); ++i) {
    const calib::ExplainedStep& step = of.steps[i];
    Json fitted = Json::array();
    for (const calib::FittedParameter& p : step.fitted) {
      fitted.push_back({{"name", p.name},
                        {"value", p.value},
                        {"sigma", NumberOrNull(p.sigma)},
                        {"unit", p.unit},
                        {"status", ToString(p.status)}});
    }
    const auto change = [&](double value) { return i == 0 ? Json(nullptr) : Json(value); };
    Json json = {{"part", ToString(step.part)}, {"what", WhatOf(step.part)}};
    json.update(FiguresJson(explained.judged, i));
    json.update({{"used_nats_per_pixel", step.nats_used},
                 {"aic_change", change(step.aic_change)},
                 {"bic_change", change(step.bic_change)},
                 {"determined_values", step.determined},
                 {"fitted", fitted}});
    Json by_frame = Json::array();
    for (const workflow::JudgedSteps& judged : explained.by_frame) {
      Json frame = {{"index", judged.frames.front()}};
      frame.update(FiguresJson(judged, i));
      by_frame.push_back(frame);
    }
    json["by_frame"] = by_frame;
    steps.push_back(json);
  }
  Json frames = Json::array();
  for (const workflow::CauseMap& map : explained.maps) {
    std::vector<double> count(explained.cause_names.size(), 0.0);
    double bright = 0.0;
    for (const std::uint8_t cause : map.cause.values()) {
      if (cause == workflow::kNotBright) continue;
      count[cause] += 1.0;
      bright += 1.0;
    }
    Json shares = Json::object();
    for (std::size_t name = 1; name < count.size(); ++name)
      shares[explained.cause_names[name]] = bright > 0.0 ? count[name] / bright : 0.0;
    frames.push_back({{"index", map.index},
                      {"file", fmt::format("causes_{:04}.png", map.index)},
                      {"lobe_of_beam", fmt::format("lobes_{:04}.png", map.index)},
                      {"picture", fmt::format("causes_{:04}_picture.png", map.index)},
                      {"bright_cells", bright},
                      {"shares", shares}});
  }
  Json floors = Json::array();
  for (const workflow::JudgedSteps& judged : explained.by_frame)
    floors.push_back(NumberOrNull(judged.floor_error));
  Json json = {{"format", "sonar-explanation/1"},
               {"title", presentation.title},
               {"warnings", WarningsOf(explained, presentation)},
               {"caveats", presentation.caveats},
               {"judged_apart", presentation.apart},
               {"frames_used", explained.split.used},
               {"frames_held_out", explained.split.held_out},
               {"steps", steps},
               {"left_out", of.left_out},
               {"speckle_floor_error", NumberOrNull(explained.judged.floor_error)},
               {"speckle_floor_error_by_frame", floors},
               {"pixels_used", of.pixels_used},
               {"pixels_a_cell", of.pixels_per_cell},
               {"causes",
                {{"names", explained.cause_names}, {"words", CauseSentence(explained)}, {"frames", frames}}}};
  json["metrics_after"] = Json::parse(metrics::MetricsJson(explained.metrics_after.value()));
  if (explained.sample_metrics_after)
    json["sample_metrics_after"] = Json::parse(metrics::MetricsJson(*explained.sample_metrics_after));
  return json;
}

std::string ExplanationText(const workflow::ExplainedRecording& explained,
                            const ExplanationPresentation& presentation) {
  std::string text;
  for (const std::string& sentence : WarningsOf(explained, presentation))
    text += fmt::format("warning: {}\n", sentence);
  for (const workflow::JudgedSteps& judged : Judges(explained, presentation)) {
    text += fmt::format("fitted to {}, evaluated on {}\n", NamedFrames(explained.split.used),
                        NamedFrames(judged.frames));
    text += TextOf(explained, judged);
  }
  text +=
      "  errors are those of the expected image; IoU and Ns/Nr too, from 'speckle' on those of a speckled "
      "sample\n";
  for (const std::string& sentence : explained.explanation.left_out)
    text += fmt::format("  left out: {}\n", sentence);
  text += CauseSentence(explained) + "\n";
  for (const std::string& sentence : presentation.caveats) text += fmt::format("note: {}\n", sentence);
  return text;
}

}  // namespace sonarcal::report
