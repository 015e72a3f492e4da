#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/workflow/rays/ray_options.h"

namespace sonarcal::workflow {
namespace {

RecordingInfo SimulatedBy(const std::string& model, const std::string& rays, const std::string& weight) {
  RecordingInfo info;
  info.synthetic = true;
  info.details = {{"model", model}, {"rays", rays}, {"ray weight", weight}};
  return info;
}

TEST(RecordedRays, RaysOfTheRecordingAreTheDefault) {
  const RaysForFit choice =
      ChooseRays({}, SimulatedBy("paper", "300x240, frustum", "solid_angle"), EchoModel::kPaper);
  EXPECT_EQ(choice.rays.sampling, sim::Sampling::kFrustum);
  EXPECT_EQ(choice.rays.rays, (RayGridSize{300, 240}));
  EXPECT_EQ(choice.rays.ray_weight, sim::RayWeight::kSolidAngle);
  EXPECT_THAT(choice.note, ::testing::HasSubstr("frustum"));
  EXPECT_TRUE(choice.warning.empty());
  EXPECT_EQ(ChooseRays({}, SimulatedBy("paper", "512x330, beams, staggered", "even"), EchoModel::kPaper)
                .rays.sampling,
            sim::Sampling::kBeams);
}

TEST(RecordedRays, AnotherSamplingThanTheRecordingsIsWarnedOf) {
  const RecordingInfo info = SimulatedBy("paper", "1500x1200, frustum", "even");
  const RaysForFit choice = ChooseRays(RayOptions(sim::Sampling::kBeams), info, EchoModel::kPaper);
  EXPECT_EQ(choice.rays.sampling, sim::Sampling::kBeams);
  EXPECT_THAT(choice.warning, ::testing::HasSubstr("simulated with frustum rays"));
  EXPECT_TRUE(ChooseRays(RayOptions(sim::Sampling::kFrustum), info, EchoModel::kPaper).warning.empty());
}

TEST(RecordedRays, AGivenWeightIsKeptAndWarnedOf) {
  const RecordingInfo info = SimulatedBy("paper", "300x240, frustum", "even");
  RayOptions asked;
  asked.ray_weight = sim::RayWeight::kSolidAngle;
  const RaysForFit choice = ChooseRays(asked, info, EchoModel::kPaper);
  EXPECT_EQ(choice.rays.ray_weight, sim::RayWeight::kSolidAngle);
  EXPECT_EQ(choice.note, "rays as the recording states its own: 300x240, frustum");
  EXPECT_THAT(choice.warning, ::testing::HasSubstr("the fit casts frustum rays of weight solid_angle"));
}

TEST(RecordedRays, AWeightThatIsNotGivenIsThatOfTheRecording) {
  const RecordingInfo info = SimulatedBy("paper", "300x240, frustum", "solid_angle");
  const RaysForFit choice = ChooseRays(RayOptions(sim::Sampling::kFrustum), info, EchoModel::kPaper);
  EXPECT_EQ(choice.rays.ray_weight, sim::RayWeight::kSolidAngle);
  EXPECT_TRUE(choice.warning.empty());
  EXPECT_EQ(RayOptions().weight(), sim::RayWeight::kEven);
}

TEST(RecordedRays, RaysOfRecordingsOfAnotherModelAreIgnored) {
  EXPECT_EQ(ChooseRays({}, RecordingInfo(), EchoModel::kPaper).rays.sampling, sim::Sampling::kBeams);
  EXPECT_EQ(
      ChooseRays({}, SimulatedBy("coherent", "1500x1200, frustum", ""), EchoModel::kPaper).rays.sampling,
      sim::Sampling::kBeams);
  const RaysForFit acoustic =
      ChooseRays({}, SimulatedBy("paper", "300x240, frustum", "even"), EchoModel::kAcoustic);
  EXPECT_FALSE(acoustic.rays.sampling.has_value());
  EXPECT_TRUE(acoustic.note.empty());
}

}  // namespace
}  // namespace sonarcal::workflow
