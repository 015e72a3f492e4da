#include "apps/report/sections/agreement_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "apps/report/sections/residual_section.h"
#include "apps/workflow/compare.h"
#include "metrics/figures.h"
#include "tests/apps/html_check.h"
#include "tests/metrics/metrics_testing.h"

namespace sonarcal::report {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

metrics::ResidualTable ByMetre(const std::vector<std::vector<double>>& differences) {
  metrics::ResidualTable table{.by = "range", .unit = "m", .classes = {}};
  for (std::size_t i = 0; i < differences.size(); ++i) {
    metrics::ResidualClass of{
        .name = {}, .from = 1.0 + static_cast<double>(i), .to = 2.0 + static_cast<double>(i)};
    for (const double difference : differences[i]) of.sums.union_region.Add(0.5, 0.5 + difference);
    table.classes.push_back(of);
  }
  return table;
}

TEST(FindWorstBand, IsWhereTheMeanAbsoluteDifferenceIsLargest) {
  // Two classes a band; the differences of the second band cancel, and it is the worst all the same.
  const auto worst = FindWorstBand(ByMetre({{0.1, 0.1}, {0.1}, {0.5, -0.5}, {0.3}, {}, {-0.2}}), 3);
  ASSERT_TRUE(worst);
  EXPECT_EQ(worst->from, 3.0);
  EXPECT_EQ(worst->to, 5.0);
  EXPECT_NEAR(worst->mean_absolute, 1.3 / 3.0, 1e-12);
  EXPECT_NEAR(worst->bias, 0.1, 1e-12);
  EXPECT_FALSE(FindWorstBand(ByMetre({{}, {}}), 2));
  EXPECT_FALSE(FindWorstBand({}, 2));
}

TEST(FindWorstBand, ABandOfFewPixelsIsIgnored) {
  const std::vector<double> many(100, 0.1);
  const auto worst = FindWorstBand(ByMetre({many, many, {0.9}}), 3);
  ASSERT_TRUE(worst);
  EXPECT_LT(worst->from, 3.0);
}

// Two frames of one block of speckle against others, 6 grey levels brighter.
metrics::MetricsReport Compared(int frames) {
  std::vector<Frame> real;
  std::vector<Frame> simulated;
  for (int i = 0; i < frames; ++i) {
    real.push_back({{}, testing::SpeckledBlock(2 * i + 1)});
    simulated.push_back({{}, testing::SpeckledBlock(2 * i + 2)});
    for (float& value : simulated.back().image.value.values()) value = std::min(255.0F, value + 6.0F);
  }
  RecordingInfo info;
  info.sonar.axes = real.front().image.axes;
  info.scale = real.front().image.scale;
  workflow::CompareRecordingsOptions options;
  options.compare.sweep.steps = 5;
  metrics::MetricsReport report =
      workflow::CompareRecordings(MemoryRecording(info, real), MemoryRecording(info, simulated), options);
  for (int i = 0; i < frames; ++i) {
    const Mask none(real[i].image.value.rows(), real[i].image.value.cols());
    report.residuals.Add(real[i].image, simulated[i].image, none, none);
  }
  return report;
}

TEST(SummaryInWords, AgreesWithTheTables) {
  const metrics::MetricsReport metrics = Compared(4);
  const std::vector<std::string> sentences = SummaryInWords(metrics);
  ASSERT_EQ(sentences.size(), 3U);  // no object region holds residuals: nothing to be furthest off
  const metrics::ViewSummary& macro = metrics.aggregate.macro.polar;
  EXPECT_THAT(sentences[0],
              StartsWith(fmt::format("The object regions share {:.0f} % of their joint area (IoU {:.3f}",
                                     100.0 * *macro.At("iou").value, *macro.At("iou").value)));
  EXPECT_THAT(sentences[0], HasSubstr(fmt::format("{:.2f} times as large", *macro.At("ns_over_nr").value)));
  EXPECT_THAT(sentences[1], HasSubstr(fmt::format("{:.3f} of full scale on average",
                                                  *macro.At("intensity.union.mean_absolute").value)));
  EXPECT_THAT(sentences[1], HasSubstr("brighter by"));
  EXPECT_THAT(sentences[2], HasSubstr("could reach on this recording is about"));
  for (const std::string& sentence : SummaryInWords(Compared(1)))
    EXPECT_THAT(sentence, Not(HasSubstr("nan")));
  // One frame tells no floor, but its display does, in theory.
  metrics::MetricsReport one = Compared(1);
  one.noise_floor.speckle =
      metrics::SpeckleFloor{.span_db = 50.0, .speckled_simulation = 0.12, .smooth_simulation = 0.085};
  EXPECT_THAT(
      SummaryInWords(one)[2],
      AllOf(HasSubstr("was not measured: 1 real frame, two are needed."),
            HasSubstr("an expected image differs by 0.085 on average and a speckled sample by 0.120.")));
  EXPECT_THAT(SummaryInWords(Compared(1)).back(),
              StartsWith("No confidence intervals can be given: 1 frame"));
}

TEST(AgreementSections, AreWellFormedAndHoldEveryFigure) {
  const metrics::MetricsReport metrics = Compared(4);
  HtmlReport report("Title");
  report.Section("Section");
  AddThresholdSweep(report, metrics);
  AddGreyLevels(report, metrics);
  AddResiduals(report, metrics);
  AddEveryFigure(report, metrics);
  EXPECT_EQ(testing::HtmlFault(report.Html()), "");
  ASSERT_EQ(report.chart_figures().size(), 4U);  // ratios, grey values twice, residuals
  const LineChart& sweep = report.chart_figures()[0].charts.at(0);
  EXPECT_EQ(sweep.series.size(), 5U);
  EXPECT_EQ(sweep.series[3].y, [&] {
    std::vector<double> heights;
    for (const auto& height : metrics.sweep->MicroCurve(3)) heights.push_back(height.value());
    return heights;
  }());
  // Shares of a histogram add up, and its mean is the image's.
  const ChartSeries& levels = report.chart_figures()[2].charts.at(0).series.at(0);
  double share = 0.0;
  double mean = 0.0;
  for (std::size_t i = 0; i < levels.x.size(); ++i) {
    share += levels.y[i];
    mean += 0.01 * levels.y[i] * levels.x[i];
  }
  EXPECT_NEAR(share, 100.0, 1e-9);
  double expected = 0.0;
  for (int i = 0; i < 4; ++i) {
    const PolarImage image = testing::SpeckledBlock(2 * i + 1);
    for (const float value : image.value.values()) expected += value / (4.0 * 120 * 40);
  }
  EXPECT_NEAR(mean, expected, 1.0);  // two levels a class
  // Quantiles lie 6 levels above the diagonal, where neither end clips.
  const ChartSeries& quantiles = report.chart_figures()[2].charts.at(1).series.at(1);
  EXPECT_NEAR(quantiles.y[60] - quantiles.x[60], 6.0, 2.5);
  EXPECT_EQ(report.tables().size(), 2U);
  std::size_t defined = 0;
  for (const metrics::Figure& figure : metrics::Figures()) {
    defined += metrics.aggregate.macro.polar.At(figure.path).value.has_value() ||
               metrics.aggregate.micro.polar.At(figure.path).value.has_value();
  }
  EXPECT_EQ(report.tables().back().rows.size(), defined);
}

TEST(AgreementSections, GreyLevelsOfObjectsAreLeftOutIfNoFrameHasAnObject) {
  metrics::MetricsReport metrics = Compared(4);
  metrics::LevelCounts& counts = metrics.aggregate.pooled_levels.polar.Over(metrics::LevelDomain::kUnion);
  ASSERT_FALSE(counts.real.empty());
  for (std::vector<double>* levels : {&counts.real, &counts.simulated})
    std::fill(levels->begin(), levels->end(), 0.0);
  HtmlReport report("Title");
  AddGreyLevels(report, metrics);
  ASSERT_EQ(report.chart_figures().size(), 1U);
  EXPECT_THAT(report.chart_figures()[0].caption, StartsWith("Whole image"));
}

TEST(AgreementSections, NothingComparedIsNothingShown) {
  HtmlReport report("Title");
  report.Section("Section");
  AddThresholdSweep(report, {});
  AddGreyLevels(report, {});
  AddResiduals(report, {});
  EXPECT_TRUE(report.chart_figures().empty());
  EXPECT_THAT(SummaryInWords({}), ElementsAre("No object was found in either image of any frame."));
}

}  // namespace
}  // namespace sonarcal::report
