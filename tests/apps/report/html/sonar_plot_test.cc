// Axes, rings and colours of sonar images in a report.
#include "apps/report/html/sonar_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "apps/report/html/axis_ticks.h"
#include "core/types/units.h"
#include "tests/apps/html_check.h"

namespace sonarcal::report {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

// Beams of 10 degrees from -30 to 30 degrees, ranges 2 .. 8 m.
PolarAxes Axes() {
  PolarAxes axes{.range_min_m = 2.0, .range_max_m = 8.0, .range_bins = 6, .beam_azimuth_rad = {}};
  for (const double azimuth : {-25.0, -15.0, -5.0, 5.0, 15.0, 25.0})
    axes.beam_azimuth_rad.push_back(RadFromDeg(azimuth));
  return axes;
}

struct Label {
  std::string text;
  double x = 0.0;
  double y = 0.0;
};

std::vector<Label> Labels(const std::string& svg, const std::string& name) {
  const std::regex label("<text class=\"" + name + "\" x=\"([-0-9.]+)\" y=\"([-0-9.]+)\"[^>]*>([^<]*)<");
  std::vector<Label> labels;
  for (std::sregex_iterator at(svg.begin(), svg.end(), label), end; at != end; ++at)
    labels.push_back({(*at)[3], std::stod((*at)[1]), std::stod((*at)[2])});
  return labels;
}

TEST(AxisTicks, AreRoundAndWithinTheAxis) {
  EXPECT_DOUBLE_EQ(NiceStep(6.0, 6), 1.0);
  EXPECT_DOUBLE_EQ(NiceStep(6.1, 6), 2.0);
  EXPECT_DOUBLE_EQ(NiceStep(0.17, 5), 0.05);
  EXPECT_THAT(TicksWithin(-0.5, 2.0, 0.5), ElementsAre(-0.5, 0.0, 0.5, 1.0, 1.5, 2.0));
  EXPECT_THAT(TicksWithin(0.1, 0.9, 1.0), SizeIs(0));
  EXPECT_EQ(DecimalsOf(0.05), 2);
  EXPECT_EQ(DecimalsOf(20.0), 0);
}

TEST(SonarPlot, LabelsRangesAndAzimuthsOfAPolarImage) {
  const std::string svg = SonarAxesSvg(Axes(), SonarView::kPolar, 300.0, 400.0, "");
  const std::vector<Label> ranges = Labels(svg, "range");
  ASSERT_EQ(ranges.size(), 7U);
  for (int i = 0; i < 7; ++i) {
    EXPECT_EQ(ranges[i].text, std::to_string(2 + i) + " m");
    EXPECT_NEAR(ranges[i].y, i * 400.0 / 6.0, 0.06);
  }
  const std::vector<Label> azimuths = Labels(svg, "azimuth");
  ASSERT_EQ(azimuths.size(), 7U);
  EXPECT_EQ(azimuths[0].text, "\u221230\u00b0");
  EXPECT_NEAR(azimuths[0].x, 0.0, 0.06);
  EXPECT_NEAR(azimuths[5].x, 250.0, 0.06);
}

TEST(SonarPlot, FollowsUnevenBeams) {
  PolarAxes axes = Axes();
  axes.beam_azimuth_rad[5] = RadFromDeg(35.0);  // edges at 25 and 45 degrees
  const std::vector<Label> labels =
      Labels(SonarAxesSvg(axes, SonarView::kPolar, 300.0, 400.0, ""), "azimuth");
  ASSERT_EQ(labels.size(), 4U);
  EXPECT_EQ(labels[1].text, "0\u00b0");
  EXPECT_NEAR(labels[1].x, 150.0, 0.06);
  EXPECT_EQ(labels[3].text, "40\u00b0");
  EXPECT_NEAR(labels[3].x, 250.0 + 0.75 * 50.0, 0.06);
}

TEST(SonarPlot, DrawsTheRingsOfAFanAboutTheSonar) {
  const std::string svg = SonarAxesSvg(Axes(), SonarView::kFan, 400.0, 400.0, "");
  // 8 m wide and 8 - 2 cos(30 deg) m high: the height fills 400 x 6.27 / 8.
  const double unit_m = 8.0 / 400.0;
  for (const Label& label : Labels(svg, "range")) {
    const double range = std::stod(label.text);
    EXPECT_NEAR(label.y, (8.0 - range * std::cos(RadFromDeg(30.0))) / unit_m, 1.0);
    EXPECT_NEAR(label.x + 5.0, (4.0 - 0.5 * range) / unit_m, 1.0);
  }
  const std::regex arc("A([0-9.]+) ([0-9.]+) 0 0 1");
  std::vector<double> radii;
  for (std::sregex_iterator at(svg.begin(), svg.end(), arc), end; at != end; ++at)
    radii.push_back(std::stod((*at)[1]) * unit_m);
  ASSERT_EQ(radii.size(), 8U);  // seven rings and the outline
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(radii[i], 2.0 + i, 0.02);
}

TEST(SonarPlot, ColoursGreyDataAndLeavesColourPicturesAlone) {
  SonarPlot plot{.axes = Axes(), .bar = {"0", "grey level", "255"}};
  StoredPicture picture{.id = "picture-1", .rows = 6, .cols = 6, .is_grey = true};
  const std::string grey = SonarPlotSvg(plot, {picture}, 1, "alt");
  EXPECT_THAT(grey, HasSubstr("<use href=\"#picture-1\""));
  EXPECT_THAT(grey, HasSubstr("filter=\"url(#inferno)\""));
  EXPECT_THAT(grey, HasSubstr(">grey level</text>"));
  EXPECT_EQ(testing::HtmlFault("<!DOCTYPE html>" + grey), "");
  picture.is_grey = false;
  EXPECT_THAT(SonarPlotSvg(plot, {picture}, 1, "alt"), Not(HasSubstr("filter=")));
  plot.colours = SonarColours::kOverlay;
  EXPECT_THROW(SonarPlotSvg(plot, {picture}, 1, "alt"), std::logic_error);
  const std::string definitions = SonarDefinitionsSvg();
  for (const char* id : {"inferno", "regions", "in-blue", "in-orange", "bar-inferno", "bar-overlay"})
    EXPECT_THAT(definitions, HasSubstr(std::string("id=\"") + id + "\""));
}

}  // namespace
}  // namespace sonarcal::report
