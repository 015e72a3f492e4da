#include "apps/report/sections/noise_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/apps/html_check.h"

namespace sonarcal::report {
namespace {

using ::testing::HasSubstr;

// Judgement of a ping of 8 range bins and 3 beams.
calib::NoiseJudgement SmallJudgement() {
  calib::NoiseJudgement judgement;
  judgement.cells.axes = {1.0, 2.0, 8, {-0.01, 0.0, 0.01}};
  judgement.cells.last_bin = 8;
  judgement.cells.band_bins = 4;
  judgement.frames = {0};
  judgement.pings = {{.frame = 0, .ks = 0.01, .whitened = {}, .pixels = 24.0}};
  calib::NoiseAgreement& agreement = judgement.agreement;
  agreement.blocks = {{.end_bin = 8,
                       .end_beam = 3,
                       .pixels = 24.0,
                       .ks = 0.01,
                       .recorded_mean = 1.25,
                       .predicted_mean = 1.5}};
  agreement.recorded = {0.25, 0.75};
  agreement.predicted = {0.5, 0.5};
  agreement.recorded_mean = Grid<float>(2, 3, 1.0F);
  agreement.recorded_mean(1, 1) = 2.0F;
  agreement.predicted_mean = Grid<float>(2, 3, 1.5F);
  return judgement;
}

TEST(NoiseSection, SyntheticGreyLevelsAreNotCalledRecorded) {
  const calib::NoiseJudgement judgement = SmallJudgement();
  EXPECT_THAT(NoiseJudgementText(judgement, true), HasSubstr("mean grey 1.25 synthetic, 1.50 predicted"));
  EXPECT_THAT(NoiseJudgementText(judgement, false), HasSubstr("mean grey 1.25 recorded, 1.50 predicted"));
  for (const bool is_synthetic : {true, false}) {
    HtmlReport report("Title");
    AddNoiseJudgement(report, judgement, is_synthetic);
    EXPECT_EQ(testing::HtmlFault(report.Html()), "");
    ASSERT_EQ(report.tables().size(), 2U);
    EXPECT_EQ(report.tables()[1].columns.at(3).title, is_synthetic ? "Synthetic" : "Recorded");
  }
}

}  // namespace
}  // namespace sonarcal::report
