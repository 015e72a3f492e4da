#include "apps/reproduce/target_report.h"

#include <fmt/format.h>

#include <cmath>

#include "apps/report/html/html_text.h"
#include "apps/report/pictures/shown_frames.h"
#include "apps/report/sections/comparison_section.h"
#include "apps/report/sections/fit_section.h"
#include "apps/report/sections/locate_section.h"
#include "apps/report/sections/segmentation_text.h"
#include "core/types/units.h"
#include "sim/paper/paper_values.h"

namespace sonarcal::reproduce {
namespace {

std::string FigureText(const metrics::Statistic& statistic, int digits) {
  return statistic.value ? fmt::format("{:.{}f}", *statistic.value, digits) : "none";
}

void AddPose(report::HtmlReport& report, const TargetComparison& target) {
  const calib::TargetPose& pose = target.pose.best().pose;
  report.Subsection("The pose, found by a search");
  report.Facts({{"Range of the middle", fmt::format("{:.3f} m", pose.range_m)},
                {"Azimuth", fmt::format("{:.2f} deg", DegFromRad(pose.azimuth_rad))},
                {"Elevation", fmt::format("{:.1f} deg (hardly seen)", DegFromRad(pose.elevation_rad))},
                {"Yaw", fmt::format("{:.1f} deg, from the right towards ahead", DegFromRad(pose.yaw_rad))},
                {"Pitch", fmt::format("{:.1f} deg, up", DegFromRad(pose.pitch_rad))},
                {"Difference of the smoothed images",
                 fmt::format("{:.4f} rms of full scale", std::sqrt(target.pose.best().cost))}});
  report::AddCandidates(report, target.pose);
  report.Paragraph("One frame does not tell:");
  report.List(target.pose.open);
  report::Table starts{.caption = "Where the starts ended, on a coarse image, best first",
                       .columns = {{"Start"},
                                   {"Range", "m"},
                                   {"Azimuth", "deg"},
                                   {"Elevation", "deg"},
                                   {"Yaw", "deg"},
                                   {"Pitch", "deg"},
                                   {"Difference", "rms"}},
                       .rows = {}};
  for (std::size_t i = 0; i < target.pose.starts.size(); ++i) {
    const calib::PoseCandidate& c = target.pose.starts[i];
    starts.rows.push_back(
        {{fmt::format("{}", i + 1), fmt::format("{:.3f}", c.pose.range_m),
          fmt::format("{:.2f}", DegFromRad(c.pose.azimuth_rad)),
          fmt::format("{:.2f}", DegFromRad(c.pose.elevation_rad)),
          fmt::format("{:.1f}", DegFromRad(c.pose.yaw_rad)),
          fmt::format("{:.1f}", DegFromRad(c.pose.pitch_rad)), fmt::format("{:.4f}", std::sqrt(c.cost))}});
  }
  report.Add(starts);
}

void AddModels(report::HtmlReport& report, const TargetComparison& target) {
  report.Subsection("Both models on the other frame");
  report.Callout(report::CalloutKind::kLimit, "The paper model's own values", sim::kPaperDisplayRule);
  report::AddFitWarnings(report, target.paper.fit.report, "paper model");
  report::AddFitWarnings(report, target.fitted.acoustic.fit.report, "acoustic model");
  const bool synthetic = target.info.synthetic;
  const std::string real = report::RealWord(synthetic);
  report.Add(RowTable(
      TargetRows(target), fmt::format("The frame that was not fitted ({}), polar image", real),
      {"Intensity errors are mean absolute differences of grey levels over full scale.",
       fmt::format(
           "Speckled samples: means of {}. Take the occupancy of the acoustic model from them: no detector "
           "finds an object of speckle in an image without any, and the expected image's union is wide.",
           TargetComparison::kDraws),
       fmt::format(
           "The expected image against its own samples: what speckle leaves of the error, were the model "
           "right. The other {} frame has the speckle of the one judged, which no simulation has.",
           real),
       "The acoustic model of the search has a noise floor read off the fitted frame's background, and the "
       "strength found with the pose. Its curve is not fitted.",
       fmt::format("Every figure is of one {} frame, so no interval can be given.", real)}));
  report.Paragraph(
      fmt::format("The paper's model has no background and sums decibels; the noise floor and the responses "
                  "of beam and pulse, which the acoustic model has, are what brings the simulated image near "
                  "the {} one.",
                  real));
  const TargetComparison::Fitted& fitted = target.fitted;
  report::AddPictureLegend(report, real);
  const report::ShownFrames paper = report::ShowFit(target.paper);
  for (const workflow::ComparedFrame& frame : paper.examples)
    report::AddFramePictures(report, frame, "The paper's model, fitted", synthetic);
  for (const workflow::ComparedFrame& frame : fitted.expected_frames)
    report::AddFramePictures(report, frame, "The acoustic model, fitted: expected image", synthetic);
  for (const workflow::ComparedFrame& frame : fitted.sample_frames)
    report::AddFramePictures(report, frame, "The acoustic model, fitted: a speckled sample", synthetic);
  for (const workflow::RecordingFit* fit : {&target.paper, &fitted.acoustic}) {
    const char* name = fit == &target.paper ? "paper's" : "acoustic";
    report.Subsection(fmt::format("Values of the {} model, fitted to the target", name));
    if (fit->fit.usable) {
      report::AddFittedValues(report, *fit);
    } else {
      report.Callout(report::CalloutKind::kWarning, "No usable solution", fit->fit.report.termination);
    }
  }
}

}  // namespace

report::Table RowTable(const std::vector<SummaryRow>& rows, const std::string& caption,
                       std::vector<std::string> notes) {
  report::Table table{.caption = caption,
                      .columns = {{"Simulated with"},
                                  {"Ns/Nr"},
                                  {"Na/Ns"},
                                  {"Na/Nr"},
                                  {"IoU"},
                                  {"Error, union"},
                                  {"Error, overlap"},
                                  {"Error, whole image"}},
                      .rows = {},
                      .notes = std::move(notes)};
  for (const SummaryRow& row : rows) {
    const metrics::ViewSummary& view = row.metrics->aggregate.macro.polar;
    table.rows.push_back(
        {{row.name, FigureText(view.At("ns_over_nr"), 2), FigureText(view.At("na_over_ns"), 2),
          FigureText(view.At("na_over_nr"), 2), FigureText(view.At("iou"), 2),
          FigureText(view.Over(metrics::IntensityDomain::kUnion).mean_absolute, 3),
          FigureText(view.Over(metrics::IntensityDomain::kOverlap).mean_absolute, 3),
          FigureText(view.Over(metrics::IntensityDomain::kWhole).mean_absolute, 3)},
         row.muted    ? report::RowStyle::kMuted
         : row.strong ? report::RowStyle::kStrong
                      : report::RowStyle::kPlain});
  }
  return table;
}

void AddKnown(report::HtmlReport& report, const CasePlan& plan) {
  if (plan.known.empty()) return;
  report::Table table{.caption = "Known beforehand, not found by this program",
                      .columns = {{"What"}, {"Where it comes from", "", false}},
                      .rows = {}};
  for (const KnownBeforehand& known : plan.known) table.rows.push_back({{known.what, known.source}});
  report.Add(table);
}

void AddTarget(report::HtmlReport& report, const TargetComparison& target) {
  const TargetCase& study = TargetOf(target.plan);
  report.Section(study.heading);
  report.Paragraph(study.about);
  report.List(target.info.notes);
  AddKnown(report, target.plan);
  report.Callout(report::CalloutKind::kLimit, "What the held-out frame cannot show", study.limit);
  report.Paragraph("How the target is found: " +
                   report::DetectorText(target.acoustic_expected.options, target.info.synthetic));
  AddPose(report, target);
  AddModels(report, target);
}

}  // namespace sonarcal::reproduce
