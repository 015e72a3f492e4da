#include "metrics/figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "tests/metrics/metrics_testing.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::metrics {
namespace {

using testing::SpeckledBlock;

TEST(FiguresTest, EveryPathAndLabelOccursOnce) {
  std::set<std::string> paths, labels;
  for (const Figure& figure : Figures()) {
    EXPECT_TRUE(paths.insert(figure.path).second) << figure.path;
    EXPECT_TRUE(labels.insert(figure.label).second) << figure.label;
    EXPECT_EQ(Figures()[FigureIndex(figure.path)].path, figure.path);
  }
  EXPECT_THROW(FigureIndex("no_such_figure"), std::logic_error);
}

// A figure of the table that its page does not define would be one that nobody can look up.
TEST(FiguresTest, EveryNameStandsInThePageThatDefinesThem) {
  const std::string page =
      testing::ReadFile(std::filesystem::path(SONARCAL_SOURCE_DIR) / "docs/reference/metrics.md") +
      testing::ReadFile(std::filesystem::path(SONARCAL_SOURCE_DIR) / "metrics/measures/occupancy.h");
  for (const Figure& figure : Figures()) {
    const std::string name = figure.path.substr(figure.path.rfind('.') + 1);
    const bool defined =
        page.find(name + '`') != std::string::npos || page.find(" " + name + "()") != std::string::npos;
    EXPECT_TRUE(defined) << figure.path;
  }
}

TEST(FiguresTest, AveragesBecomeFigures) {
  const auto finish = [](const char* path, double average) {
    return Figures()[FigureIndex(path)].Finish(average);
  };
  EXPECT_EQ(finish("speckle.object.real.looks", 0.25), 4.0);
  EXPECT_FALSE(finish("speckle.object.real.looks", 0.0));
  EXPECT_EQ(finish("intensity.whole.rmse", 0.25), 0.5);
  EXPECT_NEAR(finish("intensity.whole.psnr_db", 0.001).value(), 30.0, 1e-12);
  EXPECT_EQ(finish("iou", 0.25), 0.25);
}

TEST(FiguresTest, FinishingAnUnfinishedValueGivesTheValue) {
  for (const Figure& figure : Figures()) {
    const double value = figure.unit == FigureUnit::kDecibel ? 20.0 : 0.4;
    const std::optional<double> average = figure.Unfinish(value);
    ASSERT_TRUE(average) << figure.path;
    EXPECT_NEAR(figure.Finish(*average).value(), value, 1e-12) << figure.path;
  }
}

// A frame against itself is as good as can be, and against another it is worse by every figure that says so.
TEST(FiguresTest, AnImageAgainstItselfIsBestByEveryFigure) {
  CompareOptions options;
  PolarImage real = SpeckledBlock(1, 40.0);
  PolarImage brighter = SpeckledBlock(2, 44.0);
  real.scale.db_span = brighter.scale.db_span = 80.0;
  PolarImage other = brighter;
  for (int row = 0; row < 120; ++row) {
    for (int col = 0; col < 40; ++col) other.value(row, col) = brighter.value(row, (col + 6) % 40);
  }
  const FrameMetrics same = CompareFrames(real, real, options);
  const FrameMetrics different = CompareFrames(real, other, options);
  int judged = 0;
  for (const Figure& figure : Figures()) {
    if (figure.better == Better::kNeither) {
      EXPECT_FALSE(figure.Badness(1.0)) << figure.path;
      continue;
    }
    const std::optional<double> best = figure.Of(same.polar);
    const std::optional<double> worse = figure.Of(different.polar);
    if (figure.averaging == Averaging::kDecibelOfMeanSquare) {
      EXPECT_FALSE(best) << "images that do not differ have no PSNR";
      continue;
    }
    if (!worse) continue;
    ASSERT_TRUE(best) << figure.path;
    ++judged;
    EXPECT_LT(*figure.Badness(*best), *figure.Badness(*worse)) << figure.path;
    if (figure.better == Better::kLower || figure.better == Better::kNearZero) {
      EXPECT_NEAR(*best, 0.0, 1e-7) << figure.path;
    } else {
      EXPECT_NEAR(*best, 1.0, 1e-12) << figure.path;
    }
  }
  EXPECT_GE(judged, 40);
}

TEST(FiguresTest, ASpeckleRatioNeedsSpeckleInTheRecording) {
  const Figure& ratio = Figures()[FigureIndex("speckle.background.scintillation_ratio")];
  ViewMetrics view;
  view.speckle.real_background = {.blocks = 1, .relative_variance = 0.5};
  EXPECT_FALSE(ratio.Of(view)) << "no block of the simulation";
  view.speckle.simulated_background = {.blocks = 2, .relative_variance = 0.5};
  EXPECT_NEAR(ratio.Of(view).value(), 0.25 / (1.0 - 0.25 / 128.0) * (1.0 - 0.5 / 128.0) / 0.5, 1e-12);
  view.speckle.real_background.relative_variance = 0.0;
  EXPECT_FALSE(ratio.Of(view)) << "an even recording";
}

TEST(FiguresTest, AFanHasEveryFigureButSpeckle) {
  PolarImage real = SpeckledBlock(1, 40.0);
  PolarImage simulated = SpeckledBlock(2, 40.0);
  real.scale.db_span = simulated.scale.db_span = 80.0;
  const FrameMetrics frame = CompareFrames(real, simulated);
  for (const Figure& figure : Figures()) {
    EXPECT_EQ(figure.Of(frame.fan).has_value(), !figure.polar_only) << figure.path;
  }
}

TEST(FiguresTest, QuotedFiguresHaveFloors) {
  const std::vector<std::string> quoted = QuotedFigures();
  EXPECT_EQ(quoted.size(), 7U);
  for (const std::string& path : quoted) {
    EXPECT_NE(Figures()[FigureIndex(path)].better, Better::kNeither) << path;
  }
}

}  // namespace
}  // namespace sonarcal::metrics
