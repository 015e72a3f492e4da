// The pictures of compared frames in a report, and what their real side is called.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "apps/report/html/html_text.h"
#include "apps/report/sections/comparison_section.h"
#include "data_io/images/image_io.h"
#include "tests/apps/html_check.h"

namespace sonarcal::report {
namespace {

using ::testing::HasSubstr;

// A picture of a single colour, but for a pixel of another.
std::vector<std::uint8_t> Png(int shade = 0) {
  Grid<std::uint8_t> image(7, 5, 90);
  image(3, 2) = static_cast<std::uint8_t>(shade);
  return data_io::EncodePng(image);
}

PolarImage Image(float value) {
  PolarImage image{
      .axes = {1.0, 2.0, 7, {-0.1, -0.05, 0.0, 0.05, 0.1}}, .scale = {}, .value = Grid<float>(7, 5)};
  image.value(3, 2) = value;
  return image;
}

workflow::ComparedFrame Compared(bool any_object) {
  workflow::ComparedFrame frame{Image(100.0F), Image(150.0F), {}};
  frame.metrics.index = 3;
  frame.metrics.masks.emplace();
  frame.metrics.masks->polar_real = Mask(7, 5);
  frame.metrics.masks->polar_simulated = Mask(7, 5);
  if (any_object) frame.metrics.masks->polar_real(3, 2) = 1;
  return frame;
}

TEST(FramePicturesInAReport, OfASyntheticRecordingAreNotCalledRecorded) {
  for (const bool synthetic : {false, true}) {
    HtmlReport report("Title");
    AddOpening(report, Compared(true), "after the fit", synthetic, {"One.", "Two."});
    AddPictureLegend(report, RealWord(synthetic));
    AddFramePictures(report, Compared(true), "Frame 3", synthetic);
    const PolarAxes axes{1.0, 2.0, 7, {-0.1, -0.05, 0.0, 0.05, 0.1}};
    report.Add(FrameViewer{.caption = "All.",
                           .frames = {{.name = "f",
                                       .figures = "IoU 1",
                                       .axes = axes,
                                       .real = Png(),
                                       .simulated = Png(),
                                       .objects = Png()}},
                           .real_is_synthetic = synthetic});
    const std::string html = report.Html();
    const std::size_t start = html.find("<body>");
    const std::string body = html.substr(start, html.find("<script>") - start);
    EXPECT_EQ(body.find("ecorded") == std::string::npos, synthetic) << body;
    EXPECT_EQ(body.find("ynthetic") != std::string::npos, synthetic) << body;
    EXPECT_EQ(testing::PicturesOf(html).size(), 8U);  // the fan of the opening is not repeated
    EXPECT_EQ(testing::PictureFault(html), "");
    EXPECT_LT(html.find("<figure class=\"pictures\">"), html.find("<p>One. Two.</p>"));
  }
}

// Every picture of a frame is drawn from six sets of data: two images and their regions, polar and as a fan.
TEST(FramePicturesInAReport, HoldTheirDataOnce) {
  HtmlReport report("Title");
  AddFramePictures(report, Compared(true), "Frame 3", false);
  AddFramePictures(report, Compared(true), "Again", true);
  const std::string html = report.Html();
  std::size_t count = 0;
  for (std::size_t at = html.find("base64,"); at != std::string::npos; at = html.find("base64,", at + 1)) {
    ++count;
    const std::string data = html.substr(at, html.find('"', at) - at);
    EXPECT_EQ(html.find(data, at + 1), std::string::npos) << data;
  }
  EXPECT_EQ(count, 6U);
  EXPECT_EQ(testing::HtmlFault(html), "");
}

TEST(FramePicturesInAReport, WithoutAnObjectSayItInsteadOfBlackRegions) {
  HtmlReport report("Title");
  AddFramePictures(report, Compared(false), "Frame 3", false);
  EXPECT_EQ(testing::PicturesOf(report.Html()).size(), 6U);
  EXPECT_THAT(report.Html(), HasSubstr("No object is found in either image."));
}

}  // namespace
}  // namespace sonarcal::report
