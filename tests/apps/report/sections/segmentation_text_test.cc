#include "apps/report/sections/segmentation_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sonarcal::report {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(DetectorText, ASyntheticImageIsNotCalledRecorded) {
  metrics::CompareOptions options;
  options.simulated_object = metrics::SimulatedObject::kEchoes;
  options.region_margin_m = 0.5;
  options.object = metrics::ObjectSearch{.material = "box"};
  EXPECT_THAT(DetectorText(options, true),
              AllOf(HasSubstr("in the synthetic image"), HasSubstr("The synthetic object"),
                    HasSubstr("not from the synthetic image"), Not(HasSubstr("recorded"))));
  EXPECT_THAT(DetectorText(options, false),
              AllOf(HasSubstr("in the recorded image"), HasSubstr("The recorded object"),
                    HasSubstr("not from the recorded image"), Not(HasSubstr("synthetic"))));
}

}  // namespace
}  // namespace sonarcal::report
