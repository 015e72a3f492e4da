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

FramePictures PicturesOfAFrame(bool any_object) {
  const auto view = [&](int shade) {
    return ViewPictures{Png(shade), Png(shade + 1), Png(shade + 2), any_object ? Png(shade + 3) : Png(90)};
  };
  return {.index = 3, .name = "f", .polar = view(0), .fan = view(10)};
}

TEST(FramePicturesInAReport, OfASyntheticRecordingAreNotCalledRecorded) {
  for (const bool synthetic : {false, true}) {
    HtmlReport report("Title");
    AddPictureLegend(report, RealWord(synthetic));
    AddFramePictures(report, PicturesOfAFrame(true), "Frame 3", synthetic);
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
    EXPECT_EQ(testing::PicturesOf(html).size(), 8U);
  }
}

TEST(FramePicturesInAReport, WithoutAnObjectSayItInsteadOfBlackRegions) {
  HtmlReport report("Title");
  AddFramePictures(report, PicturesOfAFrame(false), "Frame 3", false);
  EXPECT_EQ(testing::PicturesOf(report.Html()).size(), 6U);
  EXPECT_THAT(report.Html(), HasSubstr("No object is found in either image."));
}

}  // namespace
}  // namespace sonarcal::report
