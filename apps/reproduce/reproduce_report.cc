#include "apps/reproduce/reproduce_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "apps/report/html/html_text.h"
#include "apps/report/html/report_end.h"
#include "apps/report/pictures/sonar_picture.h"
#include "apps/report/sections/agreement_section.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/report/sections/fit_section.h"
#include "apps/reproduce/summary_rows.h"
#include "apps/reproduce/target_report.h"
#include "core/types/units.h"
#include "data_io/json/json_writer.h"
#include "sim/paper/paper_values.h"

namespace sonarcal::reproduce {
namespace {

using Json = nlohmann::ordered_json;

std::string Figure(const metrics::Statistic& statistic, int digits = 2) {
  return statistic.value ? fmt::format("{:.{}f}", *statistic.value, digits) : "none";
}

Json JsonOf(const metrics::Statistic& statistic) {
  return statistic.value ? Json(*statistic.value) : Json(nullptr);
}

report::RowStyle FittedStyle(const workflow::RecordingFit& fit) {
  return IsSound(fit) ? report::RowStyle::kStrong : report::RowStyle::kPlain;
}

void AddOccupancyTable(report::HtmlReport& report, const SyntheticComparison& synthetic) {
  report::Table table{.caption = "Occupancy, as the paper's Table 6: means over frames of the polar image",
                      .columns = {{"Data set"}, {"Ns/Nr"}, {"Na/Ns"}, {"Na/Nr"}},
                      .rows = {}};
  const auto add = [&](const std::string& name, const metrics::ViewSummary& view, report::RowStyle style) {
    table.rows.push_back(
        {{name, Figure(view.At("ns_over_nr")), Figure(view.At("na_over_ns")), Figure(view.At("na_over_nr"))},
         style});
  };
  for (std::size_t set = 0; set < synthetic.data_sets.size(); ++set) {
    const SyntheticDataSet& data = synthetic.data_sets[set];
    const SyntheticCase::DataSet& paper = SyntheticOf(synthetic.plan).data_sets[set];
    table.rows.push_back(
        {{fmt::format("Data set {} (held-out {})", set + 1, report::NamedFrames(data.frames))},
         report::RowStyle::kGroup});
    add("paper model, its own values (synthetic)", data.before.macro.polar, report::RowStyle::kPlain);
    add(FittedName("paper model", synthetic.fit) + " (synthetic)", data.after.macro.polar,
        FittedStyle(synthetic.fit));
    add(FittedName("acoustic model", synthetic.acoustic) + ", a speckled sample (synthetic)",
        data.acoustic_sample.macro.polar, FittedStyle(synthetic.acoustic));
    table.rows.push_back({{"published (other recordings)", fmt::format("{:.2f}", paper.ns_over_nr),
                           fmt::format("{:.2f}", paper.na_over_ns), fmt::format("{:.2f}", paper.na_over_nr)},
                          report::RowStyle::kMuted});
  }
  table.notes = {
      "Ours: the recorded side is synthetic. The published rows come from recordings that were never "
      "published; the two "
      "can be read side by side, not subtracted.",
      "Pooled pixel counts satisfy Na/Nr = (Na/Ns)(Ns/Nr). The published rows do not (0.75 x 1.21 = 0.91, "
      "printed 0.82), "
      "so they can only be means over frames; ours here are too."};
  report.Add(table);
}

void AddIntensityTable(report::HtmlReport& report, const SyntheticComparison& synthetic) {
  report::Table table{
      .caption = "Intensity error and simulation time, as the paper's Table 7",
      .columns = {{"Data set"}, {"X-Y image"}, {"R-theta image"}, {"Simulation time", "s a frame"}},
      .rows = {}};
  const metrics::IntensityDomain domain = synthetic.fit.after.options.intensity_domain;
  const auto add = [&](const std::string& name, const metrics::Aggregate& all, const std::string& time,
                       report::RowStyle style) {
    table.rows.push_back({{name, Figure(all.macro.fan.Over(domain).mean_absolute),
                           Figure(all.macro.polar.Over(domain).mean_absolute), time},
                          style});
  };
  for (std::size_t set = 0; set < synthetic.data_sets.size(); ++set) {
    const SyntheticDataSet& data = synthetic.data_sets[set];
    const SyntheticCase::DataSet& paper = SyntheticOf(synthetic.plan).data_sets[set];
    table.rows.push_back({{fmt::format("Data set {}", set + 1)}, report::RowStyle::kGroup});
    add("paper model, its own values (synthetic)", data.before, "", report::RowStyle::kPlain);
    add(FittedName("paper model", synthetic.fit) + " (synthetic)", data.after,
        fmt::format("{:.2f}", data.simulation_time_s), FittedStyle(synthetic.fit));
    const std::string acoustic = FittedName("acoustic model", synthetic.acoustic);
    add(acoustic + ", expected image (synthetic)", data.acoustic_expected, "",
        FittedStyle(synthetic.acoustic));
    add(acoustic + ", a speckled sample (synthetic)", data.acoustic_sample, "", report::RowStyle::kPlain);
    table.rows.push_back(
        {{"published (other recordings)", fmt::format("{:.2f}", paper.intensity_fan),
          fmt::format("{:.2f}", paper.intensity_polar), fmt::format("{:.2f}", paper.simulation_time_s)},
         report::RowStyle::kMuted});
  }
  table.notes = {
      fmt::format("Mean absolute difference of the normalised images over the {} of the two object regions.",
                  ToString(domain)),
      fmt::format("Our simulation time: tracing, shading and binning {} x {} rays on this machine, mean over "
                  "the frames of a data set; the paper's machine is another.",
                  synthetic.paper_rays.cols, synthetic.paper_rays.rows)};
  report.Add(table);
}

std::vector<std::string> FloorNotes(const metrics::NoiseFloor& floor) {
  std::vector<std::string> notes = {
      "Occupancy of the acoustic model is to be read from the sample: no detector finds an object of speckle "
      "in an image without any. Intensity errors of the sample are larger than those of the expected image, "
      "having speckle on both sides."};
  if (floor.speckle) {
    notes.push_back(fmt::format(
        "Where nothing is clipped or below the noise, speckle alone makes an error of {:.3f} to an "
        "expected image, of {:.3f} to a sample.",
        floor.speckle->smooth_simulation, floor.speckle->speckled_simulation));
  }
  return notes;
}

void AddSynthetic(report::HtmlReport& report, const SyntheticComparison& synthetic) {
  const SyntheticCase& study = SyntheticOf(synthetic.plan);
  report.Section(study.heading);
  report.Callout(report::CalloutKind::kSynthetic, "The recorded side is synthetic", study.stand_in);
  report.Paragraph(fmt::format("{} Both models are fitted to frames {} and evaluated on the {} others.",
                               study.about, report::FrameList(synthetic.fit.fit.report.frames_used),
                               synthetic.fit.fit.report.frames_held_out.size()));
  AddKnown(report, synthetic.plan);
  report.Paragraph(synthetic.absorption + " Recording and both models share it.");
  report.Callout(report::CalloutKind::kLimit, "The paper model's own values", sim::kPaperDisplayRule);
  report::AddFitWarnings(report, synthetic.fit.fit.report, "paper model");
  report::AddFitWarnings(report, synthetic.acoustic.fit.report, "acoustic model");
  AddOccupancyTable(report, synthetic);
  AddIntensityTable(report, synthetic);
  report.Add(RowTable(SyntheticRows(synthetic), "All held-out frames (synthetic), polar image",
                      FloorNotes(synthetic.acoustic.after.noise_floor)));
  report.Subsection("Frames before and after the fit of the paper's model");
  report::AddFitComparison(report, synthetic.fit);
  report.Subsection("Frames before and after the fit of the acoustic model");
  report::AddFitComparison(report, synthetic.acoustic);
  report::AddUnexplained(report, synthetic.acoustic);
  report.Subsection("Values of the paper's model, fitted to the synthetic recording");
  report::AddFittedValues(report, synthetic.fit);
  report.Subsection("Values of the acoustic model, fitted to the synthetic recording");
  report::AddFittedValues(report, synthetic.acoustic);
}

void AddShown(report::HtmlReport& report, const std::vector<ShownRecording>& shown) {
  if (shown.empty()) return;
  report.Section("Other recordings");
  report.Paragraph(
      "Read and shown, not compared: no pose and no model of the scene comes with them. Ranges grow "
      "downwards in polar "
      "pictures; fans look ahead, up.");
  for (const ShownRecording& recording : shown) {
    report.Subsection(recording.name);
    if (!recording.failure.empty()) {
      report.Callout(report::CalloutKind::kWarning, "Not read", recording.failure);
      continue;
    }
    const SonarModel& sonar = recording.info.sonar;
    report.Facts({{"Sonar", sonar.name},
                  {"Frequency", fmt::format("{:.4g} MHz", sonar.frequency_hz * 1e-6)},
                  {"Frames", fmt::format("{}", recording.frame_count)},
                  {"Window", fmt::format("{:.3f} to {:.3f} m in {} bins", sonar.axes.range_min_m,
                                         sonar.axes.range_max_m, sonar.axes.range_bins)},
                  {"Beams", fmt::format("{} from {:.2f} to {:.2f} deg", sonar.axes.beam_count(),
                                        DegFromRad(sonar.axes.beam_azimuth_rad.front()),
                                        DegFromRad(sonar.axes.beam_azimuth_rad.back()))}});
    if (!recording.info.notes.empty()) report.List(recording.info.notes);
    report.Add(report::PictureRow{
        .caption = recording.name + ", first frame",
        .pictures = {report::SonarPicture(recording.first, report::SonarView::kPolar, "Polar", {}),
                     report::SonarPicture(recording.first, report::SonarView::kFan, "Fan", {})},
        .columns = 2,
        .legend = {}});
  }
}

// The held-out frame of a real sonar, or else a synthetic one, with the fitted acoustic model.
void AddOpening(report::HtmlReport& report, const Reproduction& reproduction) {
  for (const TargetResult& target : reproduction.targets) {
    if (!target.comparison || target.comparison->fitted.expected_frames.empty()) continue;
    const TargetComparison::Fitted& fitted = target.comparison->fitted;
    std::vector<std::string> sentences = report::SummaryInWords(fitted.expected);
    sentences.resize(std::min<std::size_t>(2, sentences.size()));
    report::AddOpening(report, fitted.expected_frames.front(),
                       fmt::format("{}, with the fitted acoustic model", target.comparison->plan.label),
                       target.comparison->info.synthetic, sentences);
    return;
  }
  const workflow::RecordingFit& fit = reproduction.synthetic.acoustic;
  const std::string name = "the fit of the acoustic model";
  report::AddFitOpening(report, fit, report::FitInWords(fit, name), name);
}

void AddSummary(report::HtmlReport& report, const Reproduction& reproduction) {
  const metrics::IntensityDomain domain = reproduction.synthetic.fit.after.options.intensity_domain;
  const auto figures_of = [&](const std::string& what, const workflow::RecordingFit& paper,
                              const std::string& model, const metrics::MetricsReport& acoustic,
                              const metrics::MetricsReport& sample) {
    const metrics::ViewSummary& p = (IsSound(paper) ? paper.after : paper.before).aggregate.macro.polar;
    const metrics::ViewSummary& a = acoustic.aggregate.macro.polar;
    const metrics::ViewSummary& s = sample.aggregate.macro.polar;
    const auto figure = [&](const char* label, const metrics::ViewSummary& view, const std::string& image) {
      const bool iou = std::string_view(label) == "IoU of the object";
      return report::KeyFigure{
          .label = fmt::format("{}, {}", what, label),
          .value = iou ? Figure(view.At("iou")) : Figure(view.Over(domain).mean_absolute, 3),
          .unit = iou ? "" : "of full scale",
          .note = image};
    };
    constexpr const char* kIou = "IoU of the object";
    constexpr const char* kError = "intensity error";
    // The key figures show no doubtful fit.
    const std::string paper_image = IsSound(paper) ? "paper model, fitted: expected image"
                                                   : "paper model, its own values: expected image";
    const std::string expected_image = model + ": expected image";
    const std::string sample_image = model + ": speckled sample";
    return std::vector<report::KeyFigure>{figure(kIou, p, paper_image),    figure(kError, p, paper_image),
                                          figure(kIou, a, expected_image), figure(kError, a, expected_image),
                                          figure(kIou, s, sample_image),   figure(kError, s, sample_image)};
  };
  constexpr const char* kFitted = "acoustic model, fitted";
  const SyntheticComparison& synthetic = reproduction.synthetic;
  const workflow::RecordingFit& acoustic_fit = synthetic.acoustic;
  const std::string of_synthetic = synthetic.plan.label + " (synthetic)";
  std::vector<report::KeyFigure> figures =
      IsSound(acoustic_fit)
          ? figures_of(of_synthetic, synthetic.fit, kFitted, acoustic_fit.after, *acoustic_fit.sample_after)
          : figures_of(of_synthetic, synthetic.fit, "acoustic model, before its fit", acoustic_fit.before,
                       *acoustic_fit.sample_before);
  for (const TargetResult& target : reproduction.targets) {
    if (!target.comparison) continue;
    const TargetComparison::Fitted& fitted = target.comparison->fitted;
    const workflow::RecordingFit& paper = target.comparison->paper;
    if (!paper.fit.usable || !fitted.acoustic.fit.usable) continue;
    const std::string name = fmt::format("{} ({})", target.comparison->plan.label,
                                         report::RealWord(target.comparison->info.synthetic));
    const auto of_target =
        IsSound(fitted.acoustic)
            ? figures_of(name, paper, kFitted, fitted.expected, fitted.samples)
            : figures_of(name, paper, "acoustic model of the search", target.comparison->acoustic_expected,
                         target.comparison->acoustic_samples);
    figures.insert(figures.end(), of_target.begin(), of_target.end());
  }
  report.KeyFigures(figures);
  for (const TargetResult& target : reproduction.targets) {
    if (!target.comparison) report.Callout(report::CalloutKind::kNote, "No real recording", target.absent);
  }
}

Json TargetJson(const TargetResult& result) {
  if (!result.comparison) return {{"absent_because", result.absent}};
  const TargetComparison& target = *result.comparison;
  const calib::TargetPose& pose = target.pose.best().pose;
  Json json = {{"synthetic", target.info.synthetic},
               {"known_beforehand", KnownSentences(target.plan)},
               {"pose",
                {{"range_m", pose.range_m},
                 {"azimuth_deg", DegFromRad(pose.azimuth_rad)},
                 {"elevation_deg", DegFromRad(pose.elevation_rad)},
                 {"yaw_deg", DegFromRad(pose.yaw_rad)},
                 {"pitch_deg", DegFromRad(pose.pitch_rad)},
                 {"rms_difference", std::sqrt(target.pose.best().cost)},
                 {"not_told_by_one_frame", target.pose.open}}},
               {"acoustic_expected", Json::parse(metrics::MetricsJson(target.acoustic_expected))},
               {"acoustic_samples", Json::parse(metrics::MetricsJson(target.acoustic_samples))}};
  if (target.paper.fit.usable) {
    json["metrics_before"] = Json::parse(metrics::MetricsJson(target.paper.before));
    json["metrics_after"] = Json::parse(metrics::MetricsJson(target.paper.after));
  }
  json["rows"] = Json::parse(SummaryJson(TargetRows(target)));
  return json;
}

}  // namespace

report::HtmlReport MakeReproductionReport(const Reproduction& reproduction,
                                          const nlohmann::ordered_json& provenance) {
  report::HtmlReport report("Simulated and recorded sonar images",
                            "The comparison of Park, Sensors 2024, 24(23), 7835, made again");
  AddOpening(report, reproduction);
  AddSummary(report, reproduction);
  AddSynthetic(report, reproduction.synthetic);
  for (const TargetResult& target : reproduction.targets) {
    if (target.comparison) AddTarget(report, *target.comparison);
  }
  AddShown(report, reproduction.shown);
  report::AddMetricDefinitions(report, reproduction.synthetic.fit.after);
  report::EndReport(report, provenance);
  return report;
}

std::string ReproductionMetricsJson(const Reproduction& reproduction) {
  const SyntheticComparison& synthetic = reproduction.synthetic;
  Json json = Json::parse(metrics::MetricsJson(synthetic.fit.after));
  json["metrics_before"] = Json::parse(metrics::MetricsJson(synthetic.fit.before));
  const auto summary = [&](const metrics::Aggregate& all) {
    const metrics::IntensityDomain domain = synthetic.fit.after.options.intensity_domain;
    return Json{{"ns_over_nr", JsonOf(all.macro.polar.At("ns_over_nr"))},
                {"na_over_ns", JsonOf(all.macro.polar.At("na_over_ns"))},
                {"na_over_nr", JsonOf(all.macro.polar.At("na_over_nr"))},
                {"intensity_error",
                 {{"polar", JsonOf(all.macro.polar.Over(domain).mean_absolute)},
                  {"fan", JsonOf(all.macro.fan.Over(domain).mean_absolute)}}}};
  };
  json["paper_display_rule"] = sim::kPaperDisplayRule;
  json["paper_fit_warnings"] = synthetic.fit.fit.report.warnings;
  json["acoustic"] = {
      {"metrics_before", Json::parse(metrics::MetricsJson(synthetic.acoustic.before))},
      {"metrics_after", Json::parse(metrics::MetricsJson(synthetic.acoustic.after))},
      {"sample_metrics_after", Json::parse(metrics::MetricsJson(*synthetic.acoustic.sample_after))}};
  json["summary"] = {{"synthetic", true}, {"rows", Json::parse(SummaryJson(SyntheticRows(synthetic)))}};
  json["data_sets"] = Json::array();
  for (std::size_t set = 0; set < synthetic.data_sets.size(); ++set) {
    const SyntheticDataSet& data = synthetic.data_sets[set];
    const SyntheticCase::DataSet& paper = SyntheticOf(synthetic.plan).data_sets[set];
    json["data_sets"].push_back(
        {{"data_set", set + 1},
         {"synthetic", true},
         {"frames", data.frames},
         {"before", summary(data.before)},
         {"after", summary(data.after)},
         {"acoustic_expected", summary(data.acoustic_expected)},
         {"acoustic_sample", summary(data.acoustic_sample)},
         {"simulation_time_s", data.simulation_time_s},
         {"published",
          {{"ns_over_nr", paper.ns_over_nr},
           {"na_over_ns", paper.na_over_ns},
           {"na_over_nr", paper.na_over_nr},
           {"intensity_error", {{"polar", paper.intensity_polar}, {"fan", paper.intensity_fan}}},
           {"simulation_time_s", paper.simulation_time_s}}}});
  }
  for (const TargetResult& target : reproduction.targets) json[target.name] = TargetJson(target);
  return data_io::JsonText(json);
}

}  // namespace sonarcal::reproduce
