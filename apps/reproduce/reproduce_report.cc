#include "apps/reproduce/reproduce_report.h"

#include <fmt/format.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "apps/report/html/report_end.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/report/sections/fit_section.h"
#include "apps/reproduce/bomb_report.h"
#include "apps/reproduce/paper_tables.h"
#include "apps/reproduce/summary_rows.h"
#include "core/types/units.h"
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

void AddOccupancyTable(report::HtmlReport& report, const TankComparison& tank) {
  report::Table table{.caption = "Occupancy, as the paper's Table 6: means over frames of the polar image",
                      .columns = {{"Data set"}, {"Ns/Nr"}, {"Na/Ns"}, {"Na/Nr"}},
                      .rows = {}};
  const auto add = [&](const std::string& name, const metrics::ViewSummary& view, report::RowStyle style) {
    table.rows.push_back(
        {{name, Figure(view.At("ns_over_nr")), Figure(view.At("na_over_ns")), Figure(view.At("na_over_nr"))},
         style});
  };
  for (int set = 0; set < kTankDataSets; ++set) {
    const TankDataSet& data = tank.data_sets[set];
    const PublishedDataSet& paper = kPublished[set];
    table.rows.push_back(
        {{fmt::format("Data set {} (held-out frames {})", set + 1, report::FrameList(data.frames))},
         report::RowStyle::kGroup});
    add("paper model, its own values (synthetic)", data.before.macro.polar, report::RowStyle::kPlain);
    add(FittedName(tank.fit) + " (synthetic)", data.after.macro.polar, FittedStyle(tank.fit));
    add("acoustic model, fitted, a speckled sample (synthetic)", data.acoustic_sample.macro.polar,
        report::RowStyle::kStrong);
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

void AddIntensityTable(report::HtmlReport& report, const TankComparison& tank) {
  report::Table table{
      .caption = "Intensity error and simulation time, as the paper's Table 7",
      .columns = {{"Data set"}, {"X-Y image"}, {"R-theta image"}, {"Simulation time", "s a frame"}},
      .rows = {}};
  const metrics::IntensityDomain domain = tank.fit.after.options.intensity_domain;
  const auto add = [&](const std::string& name, const metrics::Aggregate& all, const std::string& time,
                       report::RowStyle style) {
    table.rows.push_back({{name, Figure(all.macro.fan.Over(domain).mean_absolute),
                           Figure(all.macro.polar.Over(domain).mean_absolute), time},
                          style});
  };
  for (int set = 0; set < kTankDataSets; ++set) {
    const TankDataSet& data = tank.data_sets[set];
    const PublishedDataSet& paper = kPublished[set];
    table.rows.push_back({{fmt::format("Data set {}", set + 1)}, report::RowStyle::kGroup});
    add("paper model, its own values (synthetic)", data.before, "", report::RowStyle::kPlain);
    add(FittedName(tank.fit) + " (synthetic)", data.after, fmt::format("{:.2f}", data.simulation_time_s),
        FittedStyle(tank.fit));
    add("acoustic model, fitted, expected image (synthetic)", data.acoustic_expected, "",
        report::RowStyle::kStrong);
    add("acoustic model, fitted, a speckled sample (synthetic)", data.acoustic_sample, "",
        report::RowStyle::kPlain);
    table.rows.push_back(
        {{"published (other recordings)", fmt::format("{:.2f}", paper.intensity_xy),
          fmt::format("{:.2f}", paper.intensity_rtheta), fmt::format("{:.2f}", paper.simulation_time_s)},
         report::RowStyle::kMuted});
  }
  table.notes = {
      fmt::format("Mean absolute difference of the normalised images over the {} of the two object regions.",
                  ToString(domain)),
      fmt::format("Our simulation time: tracing, shading and binning {} x {} rays on this machine, mean over "
                  "the frames of a data set; the paper's machine is another.",
                  tank.paper_rays.cols, tank.paper_rays.rows)};
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

void AddTank(report::HtmlReport& report, const TankComparison& tank) {
  report.Section("The paper's tank");
  report.Callout(
      report::CalloutKind::kSynthetic, "The recorded side is synthetic",
      "The paper's recordings were never published. What stands in their place here is a simulation by "
      "another image formation than the two that are fitted: the echoes of point scatterers of random phase "
      "at the elements of an array, noise at each element, a beamformer, a logarithmic display. Agreement "
      "says how the models fare against such images, not how they fare in a tank. The acoustic model shares "
      "its formulas for one echo with it, and knows its beam, pulse and display: the comparison favours it.");
  report.Paragraph(fmt::format(
      "Two mock-ups stand in the tank of Table 5; three data sets of four frames look at the "
      "first, the second and "
      "both. Both models are fitted to frames {} and judged on the {} others.",
      report::FrameList(tank.fit.fit.report.frames_used), tank.fit.fit.report.frames_held_out.size()));
  report.Paragraph(tank.absorption + " Recording and both models share it.");
  report.Callout(report::CalloutKind::kLimit, "The paper model's own values", sim::kPaperDisplayRule);
  report::AddFitWarnings(report, tank.fit.fit.report, "paper model");
  report::AddFitWarnings(report, tank.acoustic.fit.report, "acoustic model");
  AddOccupancyTable(report, tank);
  AddIntensityTable(report, tank);
  report.Add(RowTable(TankRows(tank), "All held-out frames of the tank (synthetic), polar image",
                      FloorNotes(tank.acoustic.after.noise_floor)));
  report.Subsection("Frames before and after the fit of the paper's model");
  report::AddFitComparison(report, tank.fit);
  report.Subsection("Frames before and after the fit of the acoustic model");
  report::AddFitComparison(report, tank.acoustic);
  report::AddUnexplained(report, tank.acoustic);
  report.Subsection("Values of the paper's model, fitted to the tank");
  report::AddFittedValues(report, tank.fit);
  report.Subsection("Values of the acoustic model, fitted to the tank");
  report::AddFittedValues(report, tank.acoustic);
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
        .pictures = {{.png = recording.polar_png, .caption = "Polar", .alt = {}, .crisp = true},
                     {.png = recording.fan_png, .caption = "Fan", .alt = {}, .crisp = false}},
        .columns = 2,
        .legend = {}});
  }
}

void AddSummary(report::HtmlReport& report, const Reproduction& reproduction) {
  const metrics::IntensityDomain domain = reproduction.tank.fit.after.options.intensity_domain;
  const auto figures_of = [&](const std::string& what, const workflow::RecordingFit& paper,
                              const metrics::MetricsReport& acoustic, const metrics::MetricsReport& sample) {
    const metrics::ViewSummary& p = (IsSound(paper) ? paper.after : paper.before).aggregate.macro.polar;
    const metrics::ViewSummary& a = acoustic.aggregate.macro.polar;
    const metrics::ViewSummary& s = sample.aggregate.macro.polar;
    const auto figure = [&](const char* label, const metrics::ViewSummary& view, const char* image) {
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
    const char* paper_image = IsSound(paper) ? "paper model, fitted: expected image"
                                             : "paper model, its own values: expected image";
    return std::vector<report::KeyFigure>{figure(kIou, p, paper_image),
                                          figure(kError, p, paper_image),
                                          figure(kIou, a, "acoustic model, fitted: expected image"),
                                          figure(kError, a, "acoustic model, fitted: expected image"),
                                          figure(kIou, s, "acoustic model, fitted: speckled sample"),
                                          figure(kError, s, "acoustic model, fitted: speckled sample")};
  };
  const TankComparison& tank = reproduction.tank;
  std::vector<report::KeyFigure> figures =
      figures_of("Tank (synthetic)", tank.fit, tank.acoustic.after, *tank.acoustic.sample_after);
  if (reproduction.bomb && reproduction.bomb->fitted.paper.fit.usable &&
      reproduction.bomb->fitted.acoustic.fit.usable) {
    const BombComparison::Fitted& fitted = reproduction.bomb->fitted;
    const auto of_bomb = figures_of("Bomb (recorded)", fitted.paper, fitted.expected, fitted.samples);
    figures.insert(figures.end(), of_bomb.begin(), of_bomb.end());
  }
  report.KeyFigures(figures);
  if (!reproduction.bomb)
    report.Callout(report::CalloutKind::kNote, "No real recording", reproduction.bomb_absent);
}

}  // namespace

report::HtmlReport MakeReproductionReport(const Reproduction& reproduction,
                                          const nlohmann::ordered_json& provenance) {
  report::HtmlReport report("Simulated and recorded sonar images",
                            "The comparison of Park, Sensors 2024, 24(23), 7835, made again");
  AddSummary(report, reproduction);
  AddTank(report, reproduction.tank);
  if (reproduction.bomb) AddBomb(report, *reproduction.bomb);
  AddShown(report, reproduction.shown);
  report::AddMetricDefinitions(report, reproduction.tank.fit.after);
  report::EndReport(report, provenance);
  return report;
}

std::string ReproductionMetricsJson(const Reproduction& reproduction) {
  const TankComparison& tank = reproduction.tank;
  Json json = Json::parse(metrics::MetricsJson(tank.fit.after));
  json["metrics_before"] = Json::parse(metrics::MetricsJson(tank.fit.before));
  const auto summary = [&](const metrics::Aggregate& all) {
    const metrics::IntensityDomain domain = tank.fit.after.options.intensity_domain;
    return Json{{"ns_over_nr", JsonOf(all.macro.polar.At("ns_over_nr"))},
                {"na_over_ns", JsonOf(all.macro.polar.At("na_over_ns"))},
                {"na_over_nr", JsonOf(all.macro.polar.At("na_over_nr"))},
                {"intensity_error",
                 {{"polar", JsonOf(all.macro.polar.Over(domain).mean_absolute)},
                  {"fan", JsonOf(all.macro.fan.Over(domain).mean_absolute)}}}};
  };
  json["paper_display_rule"] = sim::kPaperDisplayRule;
  json["paper_fit_warnings"] = tank.fit.fit.report.warnings;
  json["acoustic"] = {
      {"metrics_before", Json::parse(metrics::MetricsJson(tank.acoustic.before))},
      {"metrics_after", Json::parse(metrics::MetricsJson(tank.acoustic.after))},
      {"sample_metrics_after", Json::parse(metrics::MetricsJson(*tank.acoustic.sample_after))}};
  json["summary"] = {{"synthetic", true}, {"rows", Json::parse(SummaryJson(TankRows(tank)))}};
  json["data_sets"] = Json::array();
  for (int set = 0; set < kTankDataSets; ++set) {
    const TankDataSet& data = tank.data_sets[set];
    const PublishedDataSet& paper = kPublished[set];
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
           {"intensity_error", {{"polar", paper.intensity_rtheta}, {"fan", paper.intensity_xy}}},
           {"simulation_time_s", paper.simulation_time_s}}}});
  }
  if (!reproduction.bomb) {
    json["bomb"] = {{"absent_because", reproduction.bomb_absent}};
    return json.dump(2) + "\n";
  }
  const BombComparison& bomb = *reproduction.bomb;
  const calib::TargetPose& pose = bomb.pose.best.pose;
  json["bomb"] = {{"synthetic", false},
                  {"pose",
                   {{"range_m", pose.range_m},
                    {"azimuth_deg", DegFromRad(pose.azimuth_rad)},
                    {"elevation_deg", DegFromRad(pose.elevation_rad)},
                    {"yaw_deg", DegFromRad(pose.yaw_rad)},
                    {"pitch_deg", DegFromRad(pose.pitch_rad)},
                    {"rms_difference", std::sqrt(bomb.pose.best.cost)},
                    {"not_told_by_one_frame", bomb.pose.open}}},
                  {"acoustic_expected", Json::parse(metrics::MetricsJson(bomb.acoustic_expected))},
                  {"acoustic_sample", Json::parse(metrics::MetricsJson(bomb.acoustic_sample))}};
  if (bomb.fit.fit.usable) {
    json["bomb"]["metrics_before"] = Json::parse(metrics::MetricsJson(bomb.fit.before));
    json["bomb"]["metrics_after"] = Json::parse(metrics::MetricsJson(bomb.fit.after));
  }
  json["bomb"]["fitted_outline"] = {{"rows", Json::parse(SummaryJson(BombRows(bomb)))}};
  json["bomb"]["searched_pose"] = {{"rows", Json::parse(SummaryJson(SearchedBombRows(bomb)))}};
  return json.dump(2) + "\n";
}

}  // namespace sonarcal::reproduce
