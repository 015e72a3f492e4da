#include "apps/report/pictures/saturation_pictures.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/report/html/html_text.h"
#include "apps/report/pictures/sonar_picture.h"

namespace sonarcal::report {

void AddSaturation(HtmlReport& report, const std::vector<calib::FrameSaturation>& saturation,
                   const PolarAxes& axes, const std::map<int, PolarImage>& images, bool is_synthetic) {
  if (saturation.empty()) return;
  report.Subsection("Saturated receiver");
  report.Paragraph(fmt::format(
      "In {} frame{} {}. Values that pile up stand for all higher powers. A fit of the paper's model leaves "
      "them out.",
      saturation.size(), saturation.size() == 1 ? "" : "s", calib::SaturationText(saturation)));
  Table table{.caption = "Traces of a saturated receiver",
              .columns = {{"Frame"},
                          {"Streaks along azimuth", "range", false},
                          {"Values pile up at", "grey level"},
                          {"Pixels there"}},
              .rows = {}};
  for (const calib::FrameSaturation& of : saturation) {
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
  for (const calib::FrameSaturation& of : saturation) {
    const auto image = images.find(of.frame);
    if (image == images.end() || of.streaks.empty()) continue;
    PolarImage fitted = image->second;
    for (const AzimuthStreak& streak : of.streaks) {
      for (int bin = streak.first_bin; bin < streak.end_bin; ++bin)
        std::ranges::fill(fitted.value.row(bin), 0.0F);
    }
    row.pictures.push_back(SonarPicture(image->second, SonarView::kPolar,
                                        fmt::format("Frame {}, {}", of.frame, RealWord(is_synthetic)),
                                        "recorded frame"));
    row.pictures.push_back(SonarPicture(fitted, SonarView::kPolar,
                                        fmt::format("Frame {}, as fitted", of.frame),
                                        "recorded frame without the range bins of the streaks"));
  }
  if (!row.pictures.empty()) report.Add(row);
}

}  // namespace sonarcal::report
