#include "calib/poses/pose_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/types/units.h"
#include "sim/scenes/scenes.h"
#include "tests/calib/small_body.h"

namespace sonarcal::calib {
namespace {

using testing::BodyParameters;
using testing::BodyPose;
using testing::CoarseSonar;

sim::SimulationOptions Recorder() {
  sim::SimulationOptions recorder;
  recorder.noise = true;
  recorder.fan = {.sampling = sim::Sampling::kBeams, .cols = 56 * 4, .rows = 400, .elevation_span_deg = 28.0};
  return recorder;
}

PoseSearchOptions QuickSearch() {
  PoseSearchOptions options;
  options.coarse_factor = 2;
  options.ray_height_deg = 0.15;
  options.yaw_steps = 12;
  options.refined_starts = 2;
  options.max_iterations = 12;
  return options;
}

TEST(PoseSearchTest, FindsThePoseOfASpeckledImageUpToItsMirror) {
  const Scene body = sim::MakeBody({.max_edge_m = 0.04});
  const SonarModel sonar = CoarseSonar();
  const TargetPose truth = BodyPose();
  const sim::Simulator simulator(body, sonar, Recorder());
  const PolarImage recorded = simulator.Render(truth.WorldFromSonar(), BodyParameters());

  PoseSearchOptions options = QuickSearch();
  options.ridge_elevations_deg = {0.0, 3.0};
  const PoseSearchResult found =
      SearchPose(body, sonar, Recorder().water, recorded, BodyParameters(), options);
  const TargetPose& pose = found.best.pose;
  EXPECT_NEAR(pose.range_m, truth.range_m, 0.03);
  EXPECT_NEAR(DegFromRad(pose.azimuth_rad), -3.0, 1.0);
  EXPECT_NEAR(DegFromRad(std::remainder(pose.yaw_rad - truth.yaw_rad, 2.0 * kPi)), 0.0, 8.0);
  EXPECT_NEAR(std::abs(DegFromRad(pose.pitch_rad)), 20.0, 10.0);
  EXPECT_GT(found.rays_cast, 0);
  EXPECT_GE(found.open.size(), 2u);
}

// An image without speckle: the search finds its gain and predicts it but for what its fewer rays lose (3 of
// 255 grey levels), if it knows every term of the noise. Measured with noise_db alone in place of the floor:
// gain 2.7 dB off, 8.6 grey levels.
TEST(PoseSearchTest, PredictsTheNoiseFloorThatTheParametersDescribe) {
  const Scene body = sim::MakeBody({.max_edge_m = 0.04});
  const SonarModel sonar = CoarseSonar();
  ParameterSet parameters = BodyParameters();
  ReceiverParameters& receiver = parameters.receiver;
  receiver.time_varied_gain = TimeVariedGain::k20LogR;
  receiver.noise_db = 2.0;
  receiver.noise_slope_db_per_m = 1.0;
  receiver.noise_after_gain_db = 6.0;
  for (int beam = 0; beam < 56; ++beam) {
    receiver.noise_taper_db.push_back(0.05 * beam);
    receiver.noise_after_gain_taper_db.push_back(3.0 - 0.05 * beam);
  }
  const sim::Simulator simulator(body, sonar, Recorder());
  const PolarImage recorded =
      simulator.RenderExpected(simulator.TraceEchoes(BodyPose().WorldFromSonar()), parameters);
  PoseSearchOptions options = QuickSearch();
  options.refined_starts = 1;
  options.ridge_elevations_deg = {};
  const PoseSearchResult found = SearchPose(body, sonar, Recorder().water, recorded, parameters, options);
  EXPECT_NEAR(found.best.gain_db, 0.0, 0.5);
  EXPECT_LT(255.0 * std::sqrt(found.best.cost), 4.0);
}

TEST(PoseSearchTest, TheMirrorImageIsTheSameImage) {
  const Scene body = sim::MakeBody({.max_edge_m = 0.04});
  const TargetPose pose{
      .range_m = 1.4, .azimuth_rad = 0.05, .elevation_rad = 0.03, .yaw_rad = 2.0, .pitch_rad = 0.4};
  sim::SimulationOptions options;
  options.fan = {.sampling = sim::Sampling::kBeams, .cols = 56 * 2, .rows = 400, .elevation_span_deg = 28.0};
  const sim::Simulator simulator(body, CoarseSonar(), options);
  ParameterSet parameters;
  parameters.materials["body"];
  parameters.display = {.db_min = 150.0, .db_max = 170.0};
  const PolarImage image = simulator.RenderExpected(simulator.TraceEchoes(pose.WorldFromSonar()), parameters);
  const PolarImage mirrored =
      simulator.RenderExpected(simulator.TraceEchoes(pose.Mirrored().WorldFromSonar()), parameters);
  double total = 0.0;
  double difference = 0.0;
  for (std::size_t i = 0; i < image.value.size(); ++i) {
    total += image.value.values()[i];
    difference += std::abs(image.value.values()[i] - mirrored.value.values()[i]);
  }
  ASSERT_GT(total, 0.0);
  // Facets are not mirrored about the body's axis; rays are.
  EXPECT_LT(difference, 0.05 * total);
}

TEST(PoseSearchTest, AnImageWithoutAnObjectIsRefused) {
  const SonarModel sonar = CoarseSonar();
  PolarImage empty{sonar.axes, {}, Grid<float>(120, 56, 30.0F)};
  ParameterSet parameters;
  parameters.model = EchoModel::kAcoustic;
  parameters.materials["body"];
  EXPECT_THROW(SearchPose(sim::MakeBody({.max_edge_m = 0.1}), sonar, Water{}, empty, parameters), DataError);
}

}  // namespace
}  // namespace sonarcal::calib
