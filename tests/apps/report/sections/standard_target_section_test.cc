#include "apps/report/sections/standard_target_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "tests/apps/html_check.h"

namespace sonarcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A sphere in two frames, with a window of 3 x 3 pixels.
HtmlReport ReportOfTarget(bool is_synthetic) {
  const std::vector<double> azimuth_rad = {-0.01, 0.0, 0.01};
  calib::StandardTargetFit fit;
  fit.frames = {{.frame = 0, .range_m = 3.1}, {.frame = 1, .range_m = 3.2}};
  fit.shown.bin_range_m = {3.05, 3.15, 3.25};
  fit.shown.beam_azimuth_rad = azimuth_rad;
  fit.shown.power = {1.0, 2.0, 1.0, 2.0, 6.0, 3.0, 1.0, 2.0, 1.0};
  fit.shown_model = {1.0, 2.0, 1.0, 2.0, 9.0, 2.0, 1.0, 2.0, 1.0};
  HtmlReport report("Title");
  AddStandardTarget(report, fit, {3.0, 3.3, 3, azimuth_rad}, is_synthetic);
  return report;
}

TEST(StandardTargetSection, ASyntheticSphereIsNotCalledRecorded) {
  for (const auto& [is_synthetic, word, caption, other] :
       {std::tuple{true, "synthetic", "Synthetic", "Recorded"},
        std::tuple{false, "recorded", "Recorded", "Synthetic"}}) {
    const HtmlReport report = ReportOfTarget(is_synthetic);
    const std::string html = report.Html();
    EXPECT_EQ(testing::HtmlFault(html), "");
    EXPECT_THAT(html, HasSubstr(std::string(caption) + " powers about the sphere"));
    EXPECT_THAT(html, Not(HasSubstr(std::string(other) + " powers")));
    ASSERT_FALSE(report.chart_figures().empty());
    for (const LineChart& chart : report.chart_figures()[0].charts) {
      EXPECT_EQ(chart.series.at(1).name, word);
      EXPECT_THAT(chart.alt, HasSubstr(caption));
    }
  }
}

}  // namespace
}  // namespace sonarcal::report
