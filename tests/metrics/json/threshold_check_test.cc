#include "metrics/json/threshold_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/types/error.h"

namespace sonarcal::metrics {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string MessageOfCheck(const std::string& text) {
  try {
    ParseThresholds({text});
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ThresholdCheckTest, ATextIsANameAndANumber) {
  const std::vector<Threshold> thresholds = ParseThresholds({"iou=-0.5", "a.b=1e3"});
  ASSERT_EQ(thresholds.size(), 2U);
  EXPECT_EQ(thresholds[0].name, "iou");
  EXPECT_EQ(thresholds[0].limit, -0.5);
  EXPECT_EQ(thresholds[1].name, "a.b");
  EXPECT_EQ(thresholds[1].limit, 1000.0);
  for (const char* text : {"iou", "=1", "iou=", "iou=x", "iou=1x", "iou=nan", "iou=inf", ""}) {
    EXPECT_THAT(MessageOfCheck(text), HasSubstr("expected NAME=VALUE")) << text;
  }
}

TEST(ThresholdCheckTest, FiguresAreMeansOverFramesUnlessTheirPathSaysOtherwise) {
  const nlohmann::ordered_json metrics = {
      {"macro", {{"iou", 0.5}, {"intensity_error", {{"polar", 0.25}, {"fan", nullptr}}}}},
      {"micro", {{"iou", 0.75}}},
      {"real", "tank"},
      {"iou", 9.0}};
  const auto check = [&](const std::string& name, double limit) {
    return PassedThresholds({{.name = name, .limit = limit}}, metrics);
  };
  EXPECT_THAT(check("iou", 0.5), IsEmpty()) << "the limit itself is allowed";
  EXPECT_THAT(check("iou", 0.49), ElementsAre("iou is 0.5, more than 0.49"));
  EXPECT_THAT(check("macro.iou", 0.49), ElementsAre("macro.iou is 0.5, more than 0.49"));
  EXPECT_THAT(check("micro.iou", 0.5), ElementsAre("micro.iou is 0.75, more than 0.5"));
  EXPECT_THAT(check("intensity_error.polar", 0.3), IsEmpty());
  EXPECT_THAT(check("intensity_error.fan", 1.0),
              ElementsAre("intensity_error.fan has no value, so it is not known to be within 1"));
  EXPECT_THAT(PassedThresholds({{"iou", 0.1}, {"micro.iou", 0.8}, {"micro.iou", 0.2}}, metrics),
              ElementsAre(HasSubstr("iou is"), HasSubstr("more than 0.2")));
  for (const char* name :
       {"real", "intensity_error", "iou.polar", "micro.", ".micro", "micro.iou.", "none", "macro"}) {
    EXPECT_THROW(check(name, 1.0), UsageError) << name;
  }
}

}  // namespace
}  // namespace sonarcal::metrics
