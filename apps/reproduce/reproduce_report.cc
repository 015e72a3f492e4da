#include "apps/reproduce/reproduce_report.h"

#include <fmt/format.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "apps/report/comparison_section.h"
#include "apps/report/fit_section.h"
#include "apps/reproduce/paper_tables.h"
#include "data_io/types/units.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

std::string Figure(const Statistic& statistic, int digits = 2) {
  return statistic.value ? fmt::format("{:.{}f}", *statistic.value, digits) : "none";
}

Json JsonOf(const Statistic& statistic) {
  return statistic.value ? Json(*statistic.value) : Json(nullptr);
}

void AddOccupancyTable(HtmlReport& report, const TankComparison& tank) {
  Table table{.caption = "Occupancy, as the paper's Table 6: means over frames of the polar image",
              .columns = {{"Data set"}, {"Ns/Nr"}, {"Na/Ns"}, {"Na/Nr"}},
              .rows = {}};
  const auto add = [&](const std::string& name, const ViewSummary& view, RowStyle style) {
    table.rows.push_back(
        {{name, Figure(view.ns_over_nr), Figure(view.na_over_ns), Figure(view.na_over_nr)}, style});
  };
  for (int set = 0; set < kTankDataSets; ++set) {
    const TankDataSet& data = tank.data_sets[set];
    const PublishedDataSet& paper = kPublished[set];
    table.rows.push_back({{fmt::format("Data set {} (held-out frames {})", set + 1, FrameList(data.frames))},
                          RowStyle::kGroup});
    add("ours, before the fit (synthetic)", data.before.macro.polar, RowStyle::kPlain);
    add("ours, after the fit (synthetic)", data.after.macro.polar, RowStyle::kStrong);
    table.rows.push_back({{"published (other recordings)", fmt::format("{:.2f}", paper.ns_over_nr),
                           fmt::format("{:.2f}", paper.na_over_ns), fmt::format("{:.2f}", paper.na_over_nr)},
                          RowStyle::kMuted});
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

void AddIntensityTable(HtmlReport& report, const TankComparison& tank) {
  Table table{.caption = "Intensity error and simulation time, as the paper's Table 7",
              .columns = {{"Data set"}, {"X-Y image"}, {"R-theta image"}, {"Simulation time", "s a frame"}},
              .rows = {}};
  const IntensityDomain domain = tank.fit.after.options.intensity_domain;
  const auto add = [&](const std::string& name, const Aggregate& all, const std::string& time,
                       RowStyle style) {
    table.rows.push_back({{name, Figure(all.macro.fan.Over(domain).mean_absolute),
                           Figure(all.macro.polar.Over(domain).mean_absolute), time},
                          style});
  };
  for (int set = 0; set < kTankDataSets; ++set) {
    const TankDataSet& data = tank.data_sets[set];
    const PublishedDataSet& paper = kPublished[set];
    table.rows.push_back({{fmt::format("Data set {}", set + 1)}, RowStyle::kGroup});
    add("ours, before the fit (synthetic)", data.before, "", RowStyle::kPlain);
    add("ours, after the fit (synthetic)", data.after, fmt::format("{:.2f}", data.simulation_time_s),
        RowStyle::kStrong);
    table.rows.push_back(
        {{"published (other recordings)", fmt::format("{:.2f}", paper.intensity_xy),
          fmt::format("{:.2f}", paper.intensity_rtheta), fmt::format("{:.2f}", paper.simulation_time_s)},
         RowStyle::kMuted});
  }
  table.notes = {
      fmt::format("Mean absolute difference of the normalised images over the {} of the two object regions.",
                  ToString(domain)),
      fmt::format("Our simulation time: tracing, shading and binning {} x {} rays on this machine, mean over "
                  "the frames of a data set; the paper's machine is another.",
                  tank.paper_rays.cols, tank.paper_rays.rows)};
  report.Add(table);
}

void AddTank(HtmlReport& report, const TankComparison& tank) {
  report.Section("The paper's tank");
  report.Callout(
      CalloutKind::kSynthetic, "The recorded side is synthetic",
      "The paper's recordings were never published. What stands in their place here is a simulation by "
      "another image formation than the one that is fitted: scatterers of random phase summed coherently "
      "through beam and pulse, receiver noise, a logarithmic display. Agreement says how the paper's model "
      "fares against such images, not how it fares in a tank.");
  report.Paragraph(
      fmt::format("Two mock-ups stand in the tank of Table 5; three data sets of four frames look at the "
                  "first, the second and "
                  "both. The paper's model is fitted to frames {} and judged on the {} others.",
                  FrameList(tank.fit.fit.report.frames_used), tank.fit.fit.report.frames_held_out.size()));
  AddOccupancyTable(report, tank);
  AddIntensityTable(report, tank);
  report.Subsection("Frames before and after the fit");
  AddFitComparison(report, tank.fit);
  report.Subsection("Fitted values of the tank");
  AddFittedValues(report, tank.fit);
}

void AddBombTable(HtmlReport& report, const BombComparison& bomb) {
  Table table{.caption = "The frame that was not fitted (recorded by a sonar), polar image",
              .columns = {{"Simulated with"},
                          {"Ns/Nr"},
                          {"Na/Ns"},
                          {"Na/Nr"},
                          {"IoU"},
                          {"Error, union"},
                          {"Error, overlap"},
                          {"Error, whole image"}},
              .rows = {}};
  const auto add = [&](const std::string& name, const MetricsReport& metrics, RowStyle style) {
    const ViewSummary& view = metrics.aggregate.macro.polar;
    table.rows.push_back({{name, Figure(view.ns_over_nr), Figure(view.na_over_ns), Figure(view.na_over_nr),
                           Figure(view.iou), Figure(view.union_region.mean_absolute, 3),
                           Figure(view.overlap.mean_absolute, 3), Figure(view.whole.mean_absolute, 3)},
                          style});
  };
  add("paper model, its own values", bomb.fit.before, RowStyle::kPlain);
  add("paper model, fitted", bomb.fit.after, RowStyle::kStrong);
  add("acoustic model, expected image", bomb.acoustic_expected, RowStyle::kPlain);
  add("acoustic model, one speckled sample", bomb.acoustic_sample, RowStyle::kPlain);
  table.notes = {
      "Intensity errors are mean absolute differences of grey levels over full scale; the frames' grey "
      "levels were "
      "stretched over their own range before they were published.",
      "Acoustic model: the one the pose was searched with, its noise floor read off the fitted frame's "
      "background and "
      "its strength found with the pose; its curve is not fitted.",
      "Every figure is of one frame, so no interval can be given."};
  report.Add(table);
}

void AddBomb(HtmlReport& report, const BombComparison& bomb) {
  report.Section("A bomb before an ARIS 3000");
  report.Paragraph(
      "Two frames of a body of revolution (length 737 mm, diameter 208 mm, ogive nose) in a test basin. No "
      "pose was "
      "recorded: it is searched for on the first frame. The paper's model is then fitted to the first frame, "
      "on the "
      "pixels around the object, and judged on the second.");
  report.Callout(
      CalloutKind::kLimit, "What the second frame can show",
      "Both frames show one still scene, and its speckle is frozen: judging on the second guards against "
      "fitting receiver noise, not against a wrong pose, shape or speckle grain.");
  const TargetPose& pose = bomb.pose.best.pose;
  report.Subsection("Pose found");
  report.Facts(
      {{"Range of the middle", fmt::format("{:.3f} m", pose.range_m)},
       {"Azimuth", fmt::format("{:.2f} deg", DegFromRad(pose.azimuth_rad))},
       {"Elevation", fmt::format("{:.1f} deg (hardly seen)", DegFromRad(pose.elevation_rad))},
       {"Yaw of the nose", fmt::format("{:.1f} deg, from the right towards ahead", DegFromRad(pose.yaw_rad))},
       {"Pitch of the nose", fmt::format("{:.1f} deg", DegFromRad(pose.pitch_rad))},
       {"Difference of the smoothed images",
        fmt::format("{:.4f} rms of full scale", std::sqrt(bomb.pose.best.cost))}});
  report.Paragraph("One frame does not tell:");
  report.List(bomb.pose.open);
  Table starts{.caption = "Where the starts ended, on a coarse image, best first",
               .columns = {{"Start"},
                           {"Range", "m"},
                           {"Azimuth", "deg"},
                           {"Elevation", "deg"},
                           {"Yaw", "deg"},
                           {"Pitch", "deg"},
                           {"Difference", "rms"}},
               .rows = {}};
  for (std::size_t i = 0; i < bomb.pose.starts.size(); ++i) {
    const PoseCandidate& c = bomb.pose.starts[i];
    starts.rows.push_back(
        {{fmt::format("{}", i + 1), fmt::format("{:.3f}", c.pose.range_m),
          fmt::format("{:.2f}", DegFromRad(c.pose.azimuth_rad)),
          fmt::format("{:.2f}", DegFromRad(c.pose.elevation_rad)),
          fmt::format("{:.1f}", DegFromRad(c.pose.yaw_rad)),
          fmt::format("{:.1f}", DegFromRad(c.pose.pitch_rad)), fmt::format("{:.4f}", std::sqrt(c.cost))}});
  }
  report.Add(starts);

  report.Subsection("Agreement on the other frame");
  if (!bomb.fit.fit.usable) {
    report.Callout(CalloutKind::kWarning, "No usable solution", bomb.fit.fit.report.termination);
    return;
  }
  AddBombTable(report, bomb);
  report.Paragraph(
      "The paper's model has no background and sums decibels; the noise floor and the responses of beam and "
      "pulse, which "
      "the acoustic model has, are what brings the simulated image near the recorded one.");
  AddFitComparison(report, bomb.fit);
  AddPictureLegend(report);
  for (const FramePictures& frame : bomb.acoustic_pictures) {
    AddFramePictures(report, frame, "The same frame, expected image of the acoustic model");
  }
  report.Subsection("Fitted values of the bomb");
  AddFittedValues(report, bomb.fit);
}

void AddShown(HtmlReport& report, const std::vector<ShownRecording>& shown) {
  if (shown.empty()) return;
  report.Section("Other recordings");
  report.Paragraph(
      "Read and shown, not compared: no pose and no model of the scene comes with them. Ranges grow "
      "downwards in polar "
      "pictures; fans look ahead, up.");
  for (const ShownRecording& recording : shown) {
    report.Subsection(recording.name);
    if (!recording.failure.empty()) {
      report.Callout(CalloutKind::kWarning, "Not read", recording.failure);
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
    report.Add(
        PictureRow{.caption = recording.name + ", first frame",
                   .pictures = {{.png = recording.polar_png, .caption = "Polar", .alt = {}, .crisp = true},
                                {.png = recording.fan_png, .caption = "Fan", .alt = {}, .crisp = false}},
                   .columns = 2,
                   .legend = {}});
  }
}

void AddSummary(HtmlReport& report, const Reproduction& reproduction) {
  const IntensityDomain domain = reproduction.tank.fit.after.options.intensity_domain;
  const ViewSummary& before = reproduction.tank.fit.before.aggregate.macro.polar;
  const ViewSummary& after = reproduction.tank.fit.after.aggregate.macro.polar;
  std::vector<KeyFigure> figures = {
      {.label = "Tank (synthetic), IoU of the object",
       .value = Figure(after.iou),
       .unit = {},
       .note = fmt::format("was {} before the fit", Figure(before.iou))},
      {.label = "Tank (synthetic), intensity error",
       .value = Figure(after.Over(domain).mean_absolute),
       .unit = "of full scale",
       .note = fmt::format("was {} before the fit", Figure(before.Over(domain).mean_absolute))}};
  if (reproduction.bomb && reproduction.bomb->fit.fit.usable) {
    const BombComparison& bomb = *reproduction.bomb;
    const ViewSummary& bomb_before = bomb.fit.before.aggregate.macro.polar;
    const ViewSummary& bomb_after = bomb.fit.after.aggregate.macro.polar;
    figures.push_back({.label = "Bomb (recorded), IoU of the object",
                       .value = Figure(bomb_after.iou),
                       .unit = {},
                       .note = fmt::format("was {} before the fit", Figure(bomb_before.iou))});
    figures.push_back(
        {.label = "Bomb (recorded), intensity error",
         .value = Figure(bomb_after.Over(domain).mean_absolute),
         .unit = "of full scale",
         .note = fmt::format("was {} before the fit", Figure(bomb_before.Over(domain).mean_absolute))});
  }
  report.KeyFigures(figures);
  if (!reproduction.bomb) report.Callout(CalloutKind::kNote, "No real recording", reproduction.bomb_absent);
}

}  // namespace

HtmlReport MakeReproductionReport(const Reproduction& reproduction, const std::string& provenance) {
  HtmlReport report("Simulated and recorded sonar images",
                    "The comparison of Park, Sensors 2024, 24(23), 7835, made again");
  AddSummary(report, reproduction);
  AddTank(report, reproduction.tank);
  if (reproduction.bomb) AddBomb(report, *reproduction.bomb);
  AddShown(report, reproduction.shown);
  AddMetricDefinitions(report, reproduction.tank.fit.after);
  report.Section("How this was made");
  report.Details("Provenance: version, configuration, hashes of the inputs", provenance);
  report.SetFooter("sonarcal " SONARCAL_VERSION);
  return report;
}

std::string ReproductionMetricsJson(const Reproduction& reproduction) {
  const TankComparison& tank = reproduction.tank;
  Json json = Json::parse(MetricsJson(tank.fit.after));
  json["metrics_before"] = Json::parse(MetricsJson(tank.fit.before));
  const auto summary = [&](const Aggregate& all) {
    const IntensityDomain domain = tank.fit.after.options.intensity_domain;
    return Json{{"ns_over_nr", JsonOf(all.macro.polar.ns_over_nr)},
                {"na_over_ns", JsonOf(all.macro.polar.na_over_ns)},
                {"na_over_nr", JsonOf(all.macro.polar.na_over_nr)},
                {"intensity_error",
                 {{"polar", JsonOf(all.macro.polar.Over(domain).mean_absolute)},
                  {"fan", JsonOf(all.macro.fan.Over(domain).mean_absolute)}}}};
  };
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
  const TargetPose& pose = bomb.pose.best.pose;
  json["bomb"] = {{"synthetic", false},
                  {"pose",
                   {{"range_m", pose.range_m},
                    {"azimuth_deg", DegFromRad(pose.azimuth_rad)},
                    {"elevation_deg", DegFromRad(pose.elevation_rad)},
                    {"yaw_deg", DegFromRad(pose.yaw_rad)},
                    {"pitch_deg", DegFromRad(pose.pitch_rad)},
                    {"rms_difference", std::sqrt(bomb.pose.best.cost)},
                    {"not_told_by_one_frame", bomb.pose.open}}},
                  {"acoustic_expected", Json::parse(MetricsJson(bomb.acoustic_expected))},
                  {"acoustic_sample", Json::parse(MetricsJson(bomb.acoustic_sample))}};
  if (bomb.fit.fit.usable) {
    json["bomb"]["metrics_before"] = Json::parse(MetricsJson(bomb.fit.before));
    json["bomb"]["metrics_after"] = Json::parse(MetricsJson(bomb.fit.after));
  }
  return json.dump(2) + "\n";
}

}  // namespace sonarcal
