// A SYNTHETIC recording that `simulate` made with its default seed, fitted by the same model. A sample of the
// fitted model must not draw the speckle of the recording again, which would make its figures too good.
#include <gtest/gtest.h>

#include "apps/workflow/fit.h"
#include "apps/workflow/simulate.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::workflow {
namespace {

TEST(SampleSpeckle, ASampleDiffersFromTheRecordingAsTwoSamplesDo) {
  const ParameterSet truth = testing::SmallTankAcousticTruth();
  std::vector<data_io::TimedPose> poses;
  for (const Pose& pose : testing::SmallTankPoses())
    poses.push_back({.time_s = static_cast<double>(poses.size()), .world_from_sonar = pose});
  SimulateOptions simulate;
  simulate.noise = true;
  const std::unique_ptr<MemoryRecording> recording =
      Simulate(testing::SmallTank(),
               {.sonar = testing::SmallSonar(), .water = Water{.salinity_ppt = 0.5}, .input = {}}, truth,
               poses, simulate);
  FitOptions options;
  options.free = {"receiver.noise_db"};
  options.trust_all = true;
  options.starts = 1;
  const RecordingFit fit = Fit(*recording, testing::SmallTank(), truth, options);
  ASSERT_TRUE(fit.fit.usable);
  ASSERT_TRUE(fit.sample_after);
  ASSERT_TRUE(fit.sample_pair);
  const auto error = [](const metrics::MetricsReport& report) {
    return *report.aggregate.macro.polar.Over(metrics::IntensityDomain::kWhole).mean_absolute.value;
  };
  EXPECT_NEAR(error(*fit.sample_after), error(*fit.sample_pair), 0.1 * error(*fit.sample_pair));
}

}  // namespace
}  // namespace sonarcal::workflow
