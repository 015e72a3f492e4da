#include "calib/geometry_ambiguity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sonarcal::calib {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

FitReport Fitted(const std::string& name, const std::string& unit, double value) {
  FitReport report;
  report.parameters.push_back(
      {.name = name, .unit = unit, .value = value, .sigma = 0.001, .status = ParameterStatus::kFree});
  return report;
}

// True ranges are those that the window states plus the offset. An object stated at 3.05 m that is at 3 m has
// an offset of -0.05 m. A sonar with the stated window sees it there from 0.05 m farther back.
TEST(GeometryAmbiguities, AShorterRangeLooksLikeASonarFartherBack) {
  const auto sentences = [](double offset_m, int poses) {
    return GeometryAmbiguities(Fitted("geometry.range_offset_m", "m", offset_m), poses);
  };
  EXPECT_THAT(sentences(-0.05, 1), ElementsAre(HasSubstr("0.050 m farther back along its axis")));
  EXPECT_THAT(sentences(0.05, 1), ElementsAre(HasSubstr("0.050 m farther ahead along its axis")));
  EXPECT_TRUE(sentences(-0.05, 2).empty());
}

// Ranges that are too long by 1 %, as those of a scene that is larger by 1 %.
TEST(GeometryAmbiguities, AShorterScaleLooksLikeALargerScene) {
  EXPECT_THAT(GeometryAmbiguities(Fitted("geometry.range_scale", "1", 1.0 / 1.01), 1),
              ElementsAre(HasSubstr("1.00 % larger")));
}

}  // namespace
}  // namespace sonarcal::calib
