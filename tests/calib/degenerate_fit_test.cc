#include "calib/degenerate_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sonarcal::calib {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

FittedParameter Parameter(const std::string& name, double value, ParameterStatus status) {
  return {.name = name, .unit = "", .value = value, .sigma = {}, .status = status};
}

FitReport SoundFit() {
  FitReport report;
  report.parameters = {Parameter("display.db_min", 150.0, ParameterStatus::kFixed),
                       Parameter("display.db_max", 153.0, ParameterStatus::kFree),
                       Parameter("material.floor.gsab.A", 90.0, ParameterStatus::kFree),
                       Parameter("material.floor.gsab.C", 100.0, ParameterStatus::kFree)};
  report.cost_final = 1000.0;
  return report;
}

TEST(DegenerateFit, ASoundFitHasNoWarning) {
  EXPECT_TRUE(DegenerateFitWarnings(SoundFit(), {.modelled = 0.3, .recorded = 0.25}, {}).empty());
}

TEST(DegenerateFit, SeveralValuesAtBoundsAreNamed) {
  FitReport report = SoundFit();
  report.parameters[2].status = ParameterStatus::kAtBound;
  EXPECT_TRUE(DegenerateFitWarnings(report, {}, {}).empty()) << "one may be a term that is not there";
  report.parameters[3].status = ParameterStatus::kAtBound;
  EXPECT_THAT(DegenerateFitWarnings(report, {}, {}),
              ElementsAre(HasSubstr("2 of 3 free values ended at a bound (material.floor.gsab.A, "
                                    "material.floor.gsab.C)")));
}

TEST(DegenerateFit, PixelsThatOnlyTheModelClipsAreCounted) {
  EXPECT_THAT(DegenerateFitWarnings(SoundFit(), {.modelled = 0.6, .recorded = 0.1}, {}),
              ElementsAre(HasSubstr("60 % of the pixels")));
}

TEST(DegenerateFit, ANarrowDisplayIsNamedWhereItWasFitted) {
  FitReport report = SoundFit();
  report.parameters[1].value = 150.9;
  EXPECT_THAT(DegenerateFitWarnings(report, {}, {}), ElementsAre(HasSubstr("spans 0.9 dB")));
  report.parameters[1].status = ParameterStatus::kFixed;
  EXPECT_TRUE(DegenerateFitWarnings(report, {}, {}).empty());
}

TEST(DegenerateFit, AnotherOptimumOfEqualCostIsNamed) {
  const OtherOptimum same{.cost = 1000.5, .difference = 1e-4};
  const OtherOptimum worse{.cost = 1100.0, .difference = 0.2};
  EXPECT_TRUE(DegenerateFitWarnings(SoundFit(), {}, {same, worse}).empty());
  EXPECT_THAT(DegenerateFitWarnings(SoundFit(), {}, {same, {.cost = 1001.0, .difference = 0.2}}),
              ElementsAre(HasSubstr("several optima")));
}

}  // namespace
}  // namespace sonarcal::calib
