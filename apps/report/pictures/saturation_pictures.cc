#include "apps/report/pictures/saturation_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "apps/report/html/html_text.h"
#include "apps/report/pictures/sonar_picture.h"

namespace sonarcal::report {

void AddSaturation(HtmlReport& report, const calib::FitReport& fit, const PolarAxes& axes,
                   const std::map<int, PolarImage>& streaked, bool is_synthetic) {
  if (!fit.saturation || fit.saturation->empty()) return;
  report.Subsection("Saturated receiver");
  std::string sentence = calib::SaturationText(*fit.saturation);
  sentence.front() = 'T';
  report.Paragraph(sentence + ".");
  Table table{.caption = "Traces of a saturated receiver",
              .columns = {{"Frame"},
                          {"Streaks along azimuth", "range", false},
                          {"Values pile up at", "grey level"},
                          {"Pixels there"}},
              .rows = {}};
  for (const calib::FrameSaturation& of : *fit.saturation) {
    table.rows.push_back({{fmt::format("{}", of.frame), Describe(of.streaks, axes),
                           of.level ? fmt::format("{:g}", *of.level) : "–",
                           of.level ? fmt::format("{}", of.pixels_at_level) : "–"}});
  }
  report.Add(table);
  PictureRow row{.caption = fmt::format(
                     "{} frames with streaks, beside the same frames with the left-out range bins in black",
                     RealCaption(is_synthetic)),
                 .pictures = {},
                 .columns = 2};
  for (const calib::FrameSaturation& of : *fit.saturation) {
    const auto image = streaked.find(of.frame);
    if (image == streaked.end()) continue;
    PolarImage as_fitted = image->second;
    for (const AzimuthStreak& streak : of.streaks) {
      for (int bin = streak.first_bin; bin < streak.end_bin; ++bin)
        std::ranges::fill(as_fitted.value.row(bin), 0.0F);
    }
    row.pictures.push_back(SonarPicture(image->second, SonarView::kPolar,
                                        fmt::format("Frame {}, {}", of.frame, RealWord(is_synthetic)),
                                        RealWord(is_synthetic) + " frame"));
    row.pictures.push_back(SonarPicture(as_fitted, SonarView::kPolar,
                                        fmt::format("Frame {}, as fitted", of.frame),
                                        "the frame without the range bins of the streaks"));
  }
  if (!row.pictures.empty()) report.Add(row);
}

}  // namespace sonarcal::report
