#include "apps/report/sections/locate_section.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "apps/report/html/html_text.h"
#include "apps/report/sections/comparison_section.h"
#include "calib/poses/equally_good.h"
#include "core/types/units.h"

namespace sonarcal::report {
namespace {

// "best", "the reversed target, explains the picture as well"
std::string NameOf(const calib::PoseSearchResult& search, const calib::PoseCandidate& candidate) {
  if (&candidate == &search.best()) return "best";
  return std::string(calib::NameOf(candidate.kind)) +
         (candidate.ExplainsAsWell() ? ", explains the picture as well" : "");
}

std::vector<std::string> CellsOf(const calib::PoseSearchResult& search, std::size_t i) {
  const calib::PoseCandidate& c = search.candidates[i];
  const calib::TargetPose& pose = c.pose;
  return {fmt::format("{} {}", i + 1, NameOf(search, c)),
          fmt::format("{:.3f}", pose.range_m),
          fmt::format("{:.2f}", DegFromRad(pose.azimuth_rad)),
          fmt::format("{:.2f}", DegFromRad(pose.elevation_rad)),
          fmt::format("{:.1f}", DegFromRad(pose.yaw_rad)),
          fmt::format("{:.1f}", DegFromRad(pose.pitch_rad)),
          search.symmetry.revolution == calib::Revolution::kNone
              ? fmt::format("{:.1f}", DegFromRad(pose.roll_rad))
              : "open",
          fmt::format("{:.1f}", c.gain_db),
          fmt::format("{:.5f}", std::sqrt(c.cost)),
          fmt::format("{:.1f}", c.worse_by_nats),
          fmt::format("{:.1f}", c.worse_by_sigmas)};
}

std::string IouText(const metrics::FrameMetrics& metrics) {
  const auto iou = metrics.polar.occupancy.iou();
  return iou ? fmt::format("{:.3f}", *iou) : "none";
}

std::string BothIous(const workflow::CandidateImages& images) {
  return fmt::format("{} with the expected image, {} with a speckled sample", IouText(images.of_expected),
                     IouText(images.of_sample));
}

}  // namespace

void AddCandidates(HtmlReport& report, const calib::PoseSearchResult& search) {
  Table table{
      .caption = "Poses of the target in the frame of the sonar, best first",
      .columns = {{"Pose"},
                  {"Range", "m"},
                  {"Azimuth", "deg"},
                  {"Elevation", "deg"},
                  {"Yaw", "deg"},
                  {"Pitch", "deg"},
                  {"Roll", "deg"},
                  {"Gain", "dB"},
                  {"Difference", "rms"},
                  {"Less likely by", "nats"},
                  {"Less likely by", "standard deviations"}},
      .rows = {},
      .notes = {"Range, azimuth and elevation are those of the centroid of the target's surface. Yaw and "
                "pitch are those of its axis of revolution, or of its longest direction: yaw from the "
                "right towards ahead, pitch up.",
                fmt::format(
                    "Difference: of the smoothed images, full scale 1. Less likely: ratio of the likelihoods "
                    "of the best pose and of this one, and its distance from 0 in standard deviations over "
                    "the image. Below {:g} standard deviations or {:g} nats the image does not decide "
                    "between the two.",
                    calib::kMaxWorseSigmas, calib::kMaxWorseNats)}};
  for (std::size_t i = 0; i < search.candidates.size(); ++i)
    table.rows.push_back({CellsOf(search, i), i == 0 ? RowStyle::kStrong : RowStyle::kPlain});
  report.Add(table);
}

void AddLocation(HtmlReport& report, const workflow::Location& location, bool real_is_synthetic,
                 const std::string& recording) {
  if (!location.frames.empty() && !location.frames.front().images.empty()) {
    const workflow::LocatedFrame& frame = location.frames.front();
    const workflow::CandidateImages& images = frame.images.front();
    const calib::TargetPose& pose = frame.search.candidates.front().pose;
    workflow::ComparedFrame compared{location.recording->ReadFrame(0).image, images.expected,
                                     images.of_expected};
    compared.metrics.index = frame.frame;
    AddOpening(
        report, compared, "at the best pose", real_is_synthetic,
        {fmt::format("The best pose of the target in frame {} is at a range of {:.3f} m and an azimuth of "
                     "{:.2f} deg.",
                     frame.frame, pose.range_m, DegFromRad(pose.azimuth_rad)),
         fmt::format(
             "There the object regions of the {} image and of the simulated one have an IoU of {}; the "
             "backscatter curve is not fitted.",
             RealWord(real_is_synthetic), BothIous(images))});
  }
  AddSyntheticCallout(report, real_is_synthetic, recording);
  for (std::size_t i = 0; i < location.frames.size(); ++i) {
    const workflow::LocatedFrame& frame = location.frames[i];
    const calib::PoseSearchResult& search = frame.search;
    report.Section(fmt::format("Frame {}", frame.frame));
    for (const std::string& sentence : search.best().at_bounds)
      report.Callout(CalloutKind::kWarning, "The search ended at a bound", sentence);
    AddCandidates(report, search);
    report.Paragraph("The image does not determine:");
    report.List(search.open);
    AddPictureLegend(report, RealWord(real_is_synthetic));
    const PolarImage recorded = location.recording->ReadFrame(static_cast<int>(i)).image;
    for (std::size_t k = 0; k < frame.images.size(); ++k) {
      const workflow::CandidateImages& images = frame.images[k];
      report.Subsection(fmt::format("Pose {}: {}", k + 1, NameOf(search, search.candidates[k])));
      report.Paragraph(fmt::format("IoU of the object regions: {}. The backscatter curve is not fitted.",
                                   BothIous(images)));
      workflow::ComparedFrame compared{recorded, images.expected, images.of_expected};
      compared.metrics.index = frame.frame;
      AddFramePictures(report, compared, fmt::format("Pose {}, expected image", k + 1), real_is_synthetic);
      if (k > 0) continue;
      compared = {recorded, images.sample, images.of_sample};
      compared.metrics.index = frame.frame;
      AddFramePictures(report, compared, "Pose 1, speckled sample", real_is_synthetic);
    }
  }
}

std::string LocatedText(const workflow::LocatedFrame& frame) {
  const calib::PoseSearchResult& search = frame.search;
  std::string text = fmt::format(
      "frame {}\n  {:>8}  {:>7}  {:>9}  {:>7}  {:>6}  {:>6}  {:>8}  {:>6}  {:>6}  pose\n", frame.frame,
      "range m", "az deg", "elev deg", "yaw", "pitch", "roll", "rms", "nats", "sigmas");
  for (std::size_t i = 0; i < search.candidates.size(); ++i) {
    const std::vector<std::string> cells = CellsOf(search, i);
    text += fmt::format("  {:>8}  {:>7}  {:>9}  {:>7}  {:>6}  {:>6}  {:>8}  {:>6}  {:>6}  {}\n", cells[1],
                        cells[2], cells[3], cells[4], cells[5], cells[6], cells[8], cells[9], cells[10],
                        cells[0]);
  }
  if (!frame.images.empty()) {
    text += fmt::format("  IoU of the best pose: {} with a speckled sample, the curve not fitted\n",
                        IouText(frame.images.front().of_sample));
  }
  for (const std::string& sentence : search.best().at_bounds) text += "  warning: " + sentence + "\n";
  text += "  open:\n";
  for (const std::string& sentence : search.open) text += "    " + sentence + "\n";
  return text;
}

}  // namespace sonarcal::report
