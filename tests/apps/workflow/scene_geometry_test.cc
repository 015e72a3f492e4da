#include "apps/workflow/scene_geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "apps/workflow/compare.h"
#include "core/types/error.h"
#include "core/types/pose.h"
#include "core/types/units.h"
#include "tests/apps/workflow/wall.h"

namespace sonarcal::workflow {
namespace {

TEST(SceneGeometryTest, AWallIsMetAtItsAnglesAndMaterials) {
  const SceneGeometry scene(Wall(), FlatSonar());
  const CellGeometry geometry = scene.At(Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.0}});
  int met = 0;
  for (int beam = 0; beam < 40; ++beam) {
    for (int bin = 0; bin < 400; ++bin) {
      if (geometry.material(bin, beam) == CellGeometry::kNothing) continue;
      ++met;
      EXPECT_EQ(scene.material_names()[geometry.material(bin, beam)], beam < 20 ? "steel" : "wood");
      // The incidence on a wall square ahead is the angle from its normal, and the range 3 m over its cosine.
      const double incidence_rad = geometry.incidence_rad(bin, beam);
      EXPECT_NEAR(DegFromRad(incidence_rad), std::abs(beam - 19.5), 1.2);
      EXPECT_NEAR(1.0 + (bin + 0.5) * 0.01, 3.0 / std::cos(incidence_rad), 0.012);
    }
  }
  EXPECT_GE(met, 40);
  EXPECT_LE(met, 200);
}

// One frame per pose, all of one grey.
MemoryRecording GreyRecording(const std::vector<std::optional<Pose>>& poses) {
  RecordingInfo info;
  info.sonar = FlatSonar();
  std::vector<Frame> frames;
  for (const std::optional<Pose>& pose : poses) {
    Frame frame{.info = {}, .image = {info.sonar.axes, {}, Grid<float>(400, 40, 100.0F)}};
    frame.info.world_from_sonar = pose;
    frames.push_back(std::move(frame));
  }
  return {std::move(info), std::move(frames)};
}

TEST(SceneGeometryTest, TheSceneIsSeenFromThePoseOfTheSimulationOtherwiseFromTheRecordedOne) {
  const Pose recorded{Eigen::Quaterniond::Identity(), {0.0, 1.0, 0.0}};
  const Pose rendered{Eigen::Quaterniond::Identity(), {0.0, 2.0, 0.0}};
  const MemoryRecording real = GreyRecording({recorded, recorded, std::nullopt, recorded});
  const MemoryRecording simulated = GreyRecording({rendered, std::nullopt, std::nullopt});
  EXPECT_EQ(PoseInScene(real, simulated, 0)->position_m.y(), 2.0);
  EXPECT_EQ(PoseInScene(real, simulated, 1)->position_m.y(), 1.0);
  EXPECT_FALSE(PoseInScene(real, simulated, 2));
  EXPECT_EQ(PoseInScene(real, simulated, 3)->position_m.y(), 1.0) << "the simulation has no such frame";
}

TEST(SceneGeometryTest, ResidualsOfARecordingWithoutPosesTakeThoseOfTheSimulation) {
  const SceneGeometry scene(Wall(), FlatSonar());
  const MemoryRecording real = GreyRecording({std::nullopt});
  const MemoryRecording simulated = GreyRecording({Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.0}}});
  FrameGatherer gatherer(real, simulated, &scene);
  metrics::FrameMetrics frame;
  frame.masks.emplace();
  frame.masks->polar_real = Mask(400, 40);
  frame.masks->polar_simulated = Mask(400, 40);
  gatherer.Add(real.ReadFrame(0).image, simulated.ReadFrame(0).image, frame);
  metrics::MetricsReport metrics;
  gatherer.MoveInto(metrics);
  EXPECT_TRUE(metrics.notes.empty());
  EXPECT_TRUE(metrics.residuals_by_scene.at(1).classes[0].sums.whole.bias()) << "no pixel of steel";
}

// Recorded poses decide which frames are of a static scene. Frames without a pose may be.
TEST(SceneGeometryTest, FramesOfOneRecordedPoseHaveBoxes) {
  const Pose here{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.0}};
  const Pose there{Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0}};
  EXPECT_EQ(FramesWithBoxes(GreyRecording({here, here, there, here}), {3}), (std::set<int>{0, 3}));
  EXPECT_EQ(FramesWithBoxes(GreyRecording({std::nullopt, here, there}), {2}), (std::set<int>{0, 2}));
}

TEST(SceneGeometryTest, ResidualsGoToTheirAngleAndMaterial) {
  const SonarModel sonar = FlatSonar();
  const SceneGeometry scene(Wall(), sonar);
  const CellGeometry geometry = scene.At(Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.0}});
  const PolarImage real{sonar.axes, {}, Grid<float>(400, 40, 100.0F)};
  PolarImage simulated = real;
  for (int bin = 0; bin < 400; ++bin) {
    for (int beam = 20; beam < 40; ++beam) simulated.value(bin, beam) = 151.0F;
  }
  GeometryResiduals residuals(scene.material_names());
  residuals.Add(geometry, real, simulated, Mask(400, 40), Mask(400, 40));
  const metrics::ResidualTable& by_material = residuals.tables()[1];
  ASSERT_EQ(by_material.classes.size(), 3U);
  EXPECT_NEAR(*by_material.classes[0].sums.whole.bias(), 0.0, 1e-12);
  EXPECT_NEAR(*by_material.classes[1].sums.whole.bias(), 0.2, 1e-6);
  EXPECT_EQ(by_material.classes[2].name, "(nothing met)");
  const metrics::ResidualTable& by_incidence = residuals.tables()[0];
  EXPECT_NEAR(*by_incidence.classes[1].sums.whole.bias(), 0.1, 0.02) << "as much steel as wood";
  EXPECT_FALSE(by_incidence.classes[10].sums.whole.bias());
}

// "wood" is met in beams 20 to 39, from 3 m in the middle to 3 m over the cosine of 20 degrees.
TEST(SceneGeometryTest, TheBoxOfAnObjectHoldsItsEchoesAndItsMargin) {
  const SceneGeometry scene(Wall(), FlatSonar());
  const Pose pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.0}};
  const int first = 200;  // bins of 10 mm from 1 m
  const int last = static_cast<int>((3.0 / std::cos(RadFromDeg(19.75)) - 1.0) / 0.01);
  const metrics::PixelBox tight = scene.ObjectBox(pose, {.material = "wood", .margin = {0, 0}});
  EXPECT_EQ(tight.bin_begin, first);
  EXPECT_NEAR(tight.bin_end, last + 1, 1);
  EXPECT_EQ(tight.beam_begin, 20);
  EXPECT_EQ(tight.beam_end, 40);
  const metrics::PixelBox wide = scene.ObjectBox(pose, {.material = "wood"});
  EXPECT_EQ(wide, (metrics::PixelBox{first - 12, tight.bin_end + 12, 8, 40}));
  EXPECT_TRUE(scene
                  .ObjectBox({RotationFromYawPitchRoll(RadFromDeg(60.0), 0.0, 0.0), {0.0, 0.0, 0.0}},
                             {.material = "wood"})
                  .empty());
  EXPECT_THROW(scene.ObjectBox(pose, {.material = "glass"}), DataError);
}

}  // namespace
}  // namespace sonarcal::workflow
