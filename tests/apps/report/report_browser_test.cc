// The report of a comparison in headless Chromium: what a reader sees, reads and reaches by keyboard.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "apps/report/pictures/comparison_viewer.h"
#include "apps/workflow/compare.h"
#include "core/types/units.h"
#include "data_io/open_recording.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::report {
namespace {

using testing::Quoted;
using testing::RunSonarcal;
using testing::TinyWorld;

constexpr int kNotHere = 77;

TEST(ReportInBrowser, ThePageShowsItsFramesAndLoadsNothingFromOutside) {
  const TinyWorld world;
  const auto real_path = world.WriteSimulated("real", true);
  const auto simulated_path = world.WriteSimulated("sim");
  const auto outcome = RunSonarcal("compare --real " + Quoted(real_path) + " --sim " +
                                   Quoted(simulated_path) + " --out " + Quoted(world / "out") + " -q");
  ASSERT_EQ(outcome.status, 0) << outcome.err;

  const auto real = data_io::OpenRecording(real_path);
  const auto simulated = data_io::OpenRecording(simulated_path);
  const PolarAxes& axes = real->info().sonar.axes;
  nlohmann::json expected = {
      {"frames", real->frame_count()},
      {"bins", axes.range_bins},
      {"beams", axes.beam_count()},
      {"range_m", {axes.range_min_m, axes.range_max_m}},
      {"azimuth_deg", {DegFromRad(axes.beam_azimuth_rad.front()), DegFromRad(axes.beam_azimuth_rad.back())}},
      {"samples", nlohmann::json::array()}};
  const PolarImage recorded = real->ReadFrame(0).image;
  const PolarImage rendered = simulated->ReadFrame(0).image;
  for (const auto& [bin, beam] : {std::pair{10, 3}, {40, 20}, {axes.range_bins - 1, axes.beam_count() / 2}}) {
    expected["samples"].push_back({{"bin", bin},
                                   {"beam", beam},
                                   {"real", std::lround(recorded.value(bin, beam))},
                                   {"simulated", std::lround(rendered.value(bin, beam))}});
  }
  std::ofstream(world / "expected.json") << expected.dump();

  const char* screenshots = std::getenv("SONARCAL_SCREENSHOTS");  // a folder, for who wants to look
  const std::string command = std::string(SONARCAL_PYTHON) + " " + Quoted(SONARCAL_BROWSER_SCRIPT) + " " +
                              Quoted(world / "out" / "report.html") + " " + Quoted(world / "expected.json") +
                              (screenshots != nullptr ? " " + Quoted(screenshots) : "") + " >" +
                              Quoted(world / "faults");
  const int status = WEXITSTATUS(std::system(command.c_str()));
  const std::string faults = testing::ReadFile(world / "faults");
  if (status == kNotHere) GTEST_SKIP() << faults;
  EXPECT_EQ(status, 0) << faults;
}

metrics::MetricsReport OfFrames(int count) {
  metrics::MetricsReport report;
  for (int i = 0; i < count; ++i) report.frames.emplace_back().index = i;
  return report;
}

TEST(ComparisonViewer, FramesAreSpreadAndFitThePage) {
  EXPECT_EQ(ViewerFrameCount(100, 7), 7U);
  EXPECT_EQ(ViewerFrameCount(512 * 1000, 10'000), 7U);  // 7.2 MB
  EXPECT_EQ(ViewerFrameCount(100'000'000, 10'000), 3U);
  const metrics::MetricsReport report = OfFrames(1000);
  const std::vector<int> shown = workflow::SpreadFrames(report, {3, 777}, 11);
  EXPECT_EQ(shown.size(), 11U);
  EXPECT_TRUE(std::ranges::is_sorted(shown));
  for (const int frame : {3, 777}) EXPECT_TRUE(std::ranges::binary_search(shown, frame));
  int widest = 0;
  for (std::size_t i = 1; i < shown.size(); ++i) widest = std::max(widest, shown[i] - shown[i - 1]);
  EXPECT_LE(widest, 250);
  EXPECT_EQ(workflow::SpreadFrames(OfFrames(4), {}, 4), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(workflow::SpreadFrames(OfFrames(1), {0}, 3), (std::vector<int>{0}));
}

}  // namespace
}  // namespace sonarcal::report
