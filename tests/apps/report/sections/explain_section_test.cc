#include "apps/report/sections/explain_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/apps/html_check.h"

namespace sonarcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// Two steps, the second one significant, and one frame of 4 range bins and 3 beams.
workflow::ExplainedRecording SmallStudy() {
  workflow::ExplainedRecording study;
  study.explanation.steps.resize(2);
  study.explanation.steps[1].part = calib::ExplainedPart::kNoise;
  study.explanation.pixels_used = 12.0;
  workflow::JudgedSteps& judged = study.judged;
  judged.frames = {1};
  judged.figures = {{.intensity_error = 0.2, .about_error = 0.3},
                    {.intensity_error = 0.1, .about_error = 0.2}};
  judged.nats_per_pixel = {-4.0, -3.0};
  judged.gain = {{}, {.mean = 1.0, .sigma = 0.1}};
  judged.median_error = {0.2, 0.1};
  judged.error_change = {{}, {.mean = -0.1, .sigma = 0.01}};
  judged.verdict = {calib::Verdict::kStart, calib::Verdict::kSignificant};
  study.cause_names = {"not bright", "not explained", "floor"};
  study.cause_shares = {0.0, 0.25, 0.75};
  workflow::CauseMap map{.index = 1, .cause = Grid<std::uint8_t>(4, 3), .lobe_of = {}, .recorded = {}};
  map.cause(1, 1) = 2;
  map.recorded.axes = {1.0, 2.0, 4, {-0.01, 0.0, 0.01}};
  map.recorded.value = Grid<float>(4, 3);
  map.recorded.value(1, 1) = 200.0F;
  study.maps.push_back(map);
  return study;
}

HtmlReport ReportOf(bool is_synthetic) {
  const ExplanationPresentation presentation{.about = true, .synthetic = is_synthetic};
  HtmlReport report("Title");
  AddWaterfall(report, SmallStudy(), presentation);
  AddCauses(report, SmallStudy(), presentation);
  return report;
}

TEST(ExplainSection, ASyntheticImageIsNotCalledRecorded) {
  const std::string synthetic = ReportOf(true).Html();
  EXPECT_EQ(testing::HtmlFault(synthetic), "");
  for (const char* words :
       {"beams of the object in the synthetic image.", "where the synthetic power about it"})
    EXPECT_THAT(synthetic, HasSubstr(words));
  EXPECT_THAT(synthetic, Not(HasSubstr("recorded")));
  const std::string recorded = ReportOf(false).Html();
  for (const char* words :
       {"beams of the object in the recorded image.", "where the recorded power about it"})
    EXPECT_THAT(recorded, HasSubstr(words));
  EXPECT_THAT(recorded, Not(HasSubstr("synthetic image")));
}

TEST(ExplainSection, TheNoteOfTheStepsExplainsTheirVerdict) {
  const HtmlReport report = ReportOf(false);
  const Table& steps = report.tables().at(0);
  EXPECT_EQ(steps.rows.at(1).cells.back(), "significant");
  EXPECT_THAT(steps.notes.at(0), StartsWith("Significant: the held-out frames are more likely"));
}

}  // namespace
}  // namespace sonarcal::report
