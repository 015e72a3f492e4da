#include "calib/poses/pose_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/types/units.h"
#include "sim/scenes/scene_primitives.h"
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
  options.start_spacing_deg = 30.0;
  options.refined_starts = 3;
  options.max_candidates = 2;
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
  const TargetPose& pose = found.best().pose;
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
  EXPECT_NEAR(found.best().gain_db, 0.0, 0.5);
  EXPECT_LT(255.0 * std::sqrt(found.best().cost), 4.0);
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

// One coherent sample: another image formation than the one that the search predicts with.
PolarImage RecordCoherent(const Scene& target, const Pose& sonar_from_target) {
  ParameterSet parameters = BodyParameters();
  parameters.model = EchoModel::kCoherent;
  const sim::Simulator simulator(target, CoarseSonar(), Recorder());
  return simulator.Render(sonar_from_target.Inverse(), parameters);
}

PoseSearchResult SearchCoherent(const Scene& target, const TargetPose& truth,
                                const PoseSearchOptions& options) {
  return SearchPose(target, CoarseSonar(), Recorder().water, RecordCoherent(target, truth.SonarFromTarget()),
                    BodyParameters(), options);
}

double TurnDeg(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return DegFromRad(a.angularDistance(b));
}

// Smallest turn between a candidate that explains the picture as well as the best and the truth or its mirror
// image (the hook is symmetric in its x-y plane).
double ErrorDeg(const PoseSearchResult& found, const TargetPose& truth) {
  double error_deg = 180.0;
  for (const PoseCandidate& candidate : found.candidates) {
    if (!candidate.ExplainsAsWell()) continue;
    for (const TargetPose& pose : {truth, truth.Mirrored()})
      error_deg =
          std::min(error_deg, TurnDeg(candidate.sonar_from_target.rotation, pose.SonarFromTarget().rotation));
  }
  return error_deg;
}

TEST(PoseSearchTest, FindsTheRollOfAMeshThatIsNoBodyOfRevolution) {
  const TargetPose truth{.range_m = 1.35,
                         .azimuth_rad = RadFromDeg(2.0),
                         .elevation_rad = 0.0,
                         .yaw_rad = RadFromDeg(40.0),
                         .pitch_rad = RadFromDeg(15.0),
                         .roll_rad = RadFromDeg(35.0)};
  const PoseSearchResult found = SearchCoherent(testing::MakeHook(), truth, QuickSearch());
  EXPECT_EQ(found.symmetry.revolution, Revolution::kNone);
  EXPECT_LT(ErrorDeg(found, truth), 20.0);
  const Eigen::Vector3d place = found.best().sonar_from_target.position_m;
  EXPECT_NEAR(place.head<2>().norm(), 1.35, 0.05);
}

// The floor resolves what one image of a target alone leaves open: the sonar is above it.
TEST(PoseSearchTest, FindsATargetOnAFloor) {
  Scene world = testing::MakeHook();
  world.Append(
      sim::MakePatch({-5.0, -5.0, -0.05}, {10.0, 0.0, 0.0}, {0.0, 10.0, 0.0}, sim::kUndivided, "floor"));
  ParameterSet parameters = BodyParameters();
  parameters.materials["floor"] = parameters.materials["body"];
  ParameterSet true_parameters = parameters;
  true_parameters.materials["floor"].gsab.c = 0.03;
  true_parameters.model = EchoModel::kCoherent;
  const Pose sonar_from_world{
      Eigen::AngleAxisd(RadFromDeg(30.0), Eigen::Vector3d::UnitX()) *
          Eigen::Quaterniond(Eigen::AngleAxisd(RadFromDeg(65.0), Eigen::Vector3d::UnitZ())),
      {0.05, 1.4, 0.0}};
  const sim::Simulator simulator(world, CoarseSonar(), Recorder());
  const PolarImage recorded = simulator.Render(sonar_from_world.Inverse(), true_parameters);
  PoseSearchOptions options = QuickSearch();
  options.floor_material = "floor";
  const PoseSearchResult found =
      SearchPose(world, CoarseSonar(), Recorder().water, recorded, parameters, options);
  const Pose& best = found.best().sonar_from_target;
  EXPECT_NEAR(best.position_m.norm(), 1.4, 0.05);
  EXPECT_LT(TurnDeg(best.rotation, sonar_from_world.rotation), 20.0);
  EXPECT_NEAR(found.best().floor_gain_db - found.best().gain_db, DbFromPower(0.03), 4.0);
  EXPECT_GT((best.Inverse().position_m).z(), 0.0);
}

TEST(PoseSearchTest, SaysThatTheRollOfABodyOfRevolutionIsOpen) {
  const PoseSearchResult found =
      SearchCoherent(sim::MakeBody({.max_edge_m = 0.04}), BodyPose(), QuickSearch());
  EXPECT_EQ(found.symmetry.revolution, Revolution::kAxis);
  EXPECT_TRUE(std::any_of(found.open.begin(), found.open.end(),
                          [](const std::string& text) { return text.starts_with("roll"); }));
  EXPECT_NEAR(found.best().pose.range_m, BodyPose().range_m, 0.06);
}

// A cylinder with a small cap at one end, which speckle hides.
TEST(PoseSearchTest, RanksTheReversedTargetAmongTheCandidates) {
  Scene bar = sim::MakeCylinder({-0.3, 0, 0}, {0.6, 0, 0}, 0.08, 0.03, "body");
  bar.Append(sim::MakeCylinder({0.3, 0, 0}, {0.03, 0, 0}, 0.05, 0.02, "body"));
  PoseSearchOptions options = QuickSearch();
  const PoseSearchResult found = SearchCoherent(bar, BodyPose(), options);
  ASSERT_FALSE(found.symmetry.half_turn[1]);
  const auto reversed =
      std::find_if(found.candidates.begin(), found.candidates.end(),
                   [](const auto& candidate) { return candidate.kind == CandidateKind::kReversed; });
  ASSERT_NE(reversed, found.candidates.end());
  EXPECT_GT(reversed->cost, found.best().cost);
  EXPECT_TRUE(reversed->ExplainsAsWell()) << reversed->worse_by_sigmas;
  EXPECT_TRUE(std::any_of(found.open.begin(), found.open.end(), [](const std::string& text) {
    return text.find("reversed") != std::string::npos && text.find("as well") != std::string::npos;
  }));
}

TEST(PoseSearchTest, ASearchThatEndsAtABoundSaysSo) {
  TargetPose truth = BodyPose();
  PoseSearchOptions options = QuickSearch();
  options.range_m = Interval{1.0, 1.2};  // the middle lies at 1.35 m
  const PoseSearchResult found = SearchCoherent(sim::MakeBody({.max_edge_m = 0.04}), truth, options);
  ASSERT_FALSE(found.best().at_bounds.empty());
  EXPECT_NE(found.best().at_bounds.front().find("upper bound of the range (1.200 m)"), std::string::npos)
      << found.best().at_bounds.front();
}

TEST(PoseSearchTest, ATargetOutsideTheRegionIsRefusedInOneSentence) {
  const Scene body = sim::MakeBody({.max_edge_m = 0.04});
  const PolarImage recorded = RecordCoherent(body, BodyPose().SonarFromTarget());
  PoseSearchOptions options = QuickSearch();
  options.azimuth_deg = Interval{11.0, 13.0};
  options.range_m = Interval{0.85, 0.95};
  try {
    SearchPose(body, CoarseSonar(), Recorder().water, recorded, BodyParameters(), options);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_STREQ(
        error.what(),
        "pose search: no pixel of the region of interest (range 0.85 to 0.95 m, azimuth 11 to 13 deg) is "
        "four standard deviations above the background");
  }
}

TEST(PoseSearchTest, RefinesAGivenStartWithoutASweep) {
  TargetPose start = BodyPose();
  start.range_m += 0.04;
  start.yaw_rad += RadFromDeg(8.0);
  PoseSearchOptions options = QuickSearch();
  options.start = start.SonarFromTarget();
  const PoseSearchResult found = SearchCoherent(sim::MakeBody({.max_edge_m = 0.04}), BodyPose(), options);
  EXPECT_EQ(found.starts.size(), 1u);
  EXPECT_NEAR(found.best().sonar_from_target.position_m.norm(), BodyPose().range_m, 0.03);
}

TEST(PoseSearchTest, StopsWhenAsked) {
  PoseSearchOptions options = QuickSearch();
  options.stop = [] { return true; };
  EXPECT_THROW(SearchCoherent(sim::MakeBody({.max_edge_m = 0.04}), BodyPose(), options), PoseSearchStopped);
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
