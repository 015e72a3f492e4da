// Fits about a wrong pose say so, those about the right one do not. The recordings are SYNTHETIC,
// made by the coherent model, which is not the one fitted.
#include "apps/workflow/fit_doubts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/poses/target_pose.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/scenes/scenes.h"
#include "tests/calib/small_body.h"

namespace sonarcal::workflow {
namespace {

using testing::BodyParameters;
using testing::BodyPose;
using testing::CoarseSonar;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A triangle ahead of a sonar at this pose.
void AddBackdrop(const Pose& world_from_sonar, Scene& scene) {
  const auto first = static_cast<int>(scene.vertices_m.size());
  for (const Eigen::Vector3d& corner_m :
       {Eigen::Vector3d(-0.3, 1.5, -0.3), Eigen::Vector3d(0.3, 1.5, -0.3), Eigen::Vector3d(0.0, 1.5, 0.3)})
    scene.vertices_m.emplace_back((world_from_sonar * corner_m).cast<float>());
  scene.triangles.emplace_back(first, first + 1, first + 2);
  scene.triangle_material.push_back(scene.MaterialIndex("backdrop"));
}

// A body in open water, seen once; recorded with another pose. `backdrop`: stands ahead of that pose in the
// fitted scene.
RecordingFit FitFrom(const calib::TargetPose& recorded, const std::string& free,
                     const std::optional<metrics::ObjectSearch>& object = {}, bool backdrop = false) {
  const Scene body = sim::MakeBody({.max_edge_m = 0.04});
  const SonarModel sonar = CoarseSonar();
  const calib::TargetPose truth = BodyPose();
  sim::SimulationOptions recorder;
  recorder.noise = true;
  ParameterSet coherent = BodyParameters();
  coherent.model = EchoModel::kCoherent;
  const sim::Simulator simulator(body, sonar, recorder);
  Frame frame{.info = {}, .image = simulator.Render(truth.WorldFromSonar(), coherent)};
  frame.info.name = "frame";
  frame.info.world_from_sonar = recorded.WorldFromSonar();
  RecordingInfo info;
  info.source = "body";
  info.synthetic = true;
  info.sonar = sonar;
  info.scale = frame.image.scale;

  FitRecordingOptions options;
  options.config.free = std::vector<std::string>{free};
  options.keep_images = false;
  options.comparison.object = object;
  Scene scene = body;
  ParameterSet start = BodyParameters();
  if (backdrop) {
    AddBackdrop(recorded.WorldFromSonar(), scene);
    start.materials["backdrop"] = start.materials.begin()->second;
  }
  return FitRecording(MemoryRecording(info, {frame}), scene, start, options);
}

calib::TargetPose TurnedBy(double heading_deg) {
  calib::TargetPose pose = BodyPose();
  pose.yaw_rad += RadFromDeg(heading_deg);
  return pose;
}

TEST(FitDoubts, AnObjectOutOfViewIsDoubtedFirst) {
  calib::TargetPose aside = BodyPose();
  aside.azimuth_rad = RadFromDeg(80.0);
  const RecordingFit fit =
      FitFrom(aside, "receiver.noise_db", metrics::ObjectSearch{.material = "body"}, /*backdrop=*/true);
  ASSERT_TRUE(fit.fit.usable);
  ASSERT_FALSE(fit.fit.report.warnings.empty());
  EXPECT_THAT(fit.fit.report.warnings.front(), HasSubstr("no pixel of the object in 1 of the 1 frames"));
}

TEST(FitDoubts, ASceneOutOfViewIsRefused) {
  calib::TargetPose aside = BodyPose();
  aside.azimuth_rad = RadFromDeg(80.0);
  EXPECT_THROW(FitFrom(aside, "receiver.noise_db"), DataError);
}

TEST(FitDoubts, AHeadingHeldFiftyDegreesOffIsDoubtedFirst) {
  const RecordingFit fit = FitFrom(TurnedBy(50.0), "receiver.noise_db");
  ASSERT_TRUE(fit.fit.usable);
  ASSERT_FALSE(fit.fit.report.warnings.empty());
  EXPECT_THAT(fit.fit.report.warnings.front(), HasSubstr("has not found the recorded object"));
}

// Whether the search comes back or not, either the images or the way that the pose went say so.
TEST(FitDoubts, APoseFreeFromFiftyDegreesOffIsDoubted) {
  const RecordingFit fit = FitFrom(TurnedBy(50.0), "pose");
  ASSERT_TRUE(fit.fit.usable);
  EXPECT_FALSE(fit.fit.report.warnings.empty());
}

TEST(FitDoubts, AFitFromNearTheTruthIsNotDoubted) {
  const RecordingFit fit = FitFrom(TurnedBy(2.0), "pose");
  ASSERT_TRUE(fit.fit.usable);
  EXPECT_THAT(fit.fit.report.warnings, IsEmpty());
}

TEST(FitDoubts, APoseFarFromTheRecordedOneIsNamed) {
  RecordingFit fit;
  const auto add = [&](const char* name, const char* unit, double initial, double value) {
    fit.fit.report.parameters.push_back({.name = name,
                                         .unit = unit,
                                         .value = value,
                                         .sigma = {},
                                         .initial = initial,
                                         .status = calib::ParameterStatus::kFree});
  };
  add("pose.3.yaw_deg", "deg", 179.0, -176.0);  // 5 degrees the short way round
  add("pose.3.x_m", "m", 1.0, 1.04);
  add("pose.4.yaw_deg", "deg", 10.0, 30.0);
  add("material.floor.gsab.A", "1", 1.0, 100.0);
  const calib::FitConfig config{.pose_prior = {.position_m = 0.01, .angle_deg = 3.0}};
  EXPECT_THAT(DoubtsAbout(fit, config), ElementsAre(HasSubstr("pose.4.yaw_deg ended 20 deg")));
}

}  // namespace
}  // namespace sonarcal::workflow
