#include "apps/workflow/task/labelled_frames.h"

#include <gtest/gtest.h>

#include "core/types/error.h"
#include "core/types/pose.h"
#include "tests/apps/workflow/wall.h"

namespace sonarcal::workflow {
namespace {

RecordingInfo Info(const char* source) {
  RecordingInfo info;
  info.source = source;
  info.sonar = FlatSonar();
  return info;
}

Frame FrameWith(const RecordingInfo& info, float value, bool posed = true) {
  Frame frame{{"frame", {}, {}}, {info.sonar.axes, {}, Grid<float>(400, 40, value)}};
  if (posed) frame.info.world_from_sonar = Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.0}};
  return frame;
}

TEST(LabelledFramesTest, RaysLabelTheMaterial) {
  const RecordingInfo info = Info("posed");
  const std::vector<metrics::LabelledFrame> frames =
      LabelledByScene(MemoryRecording(info, {FrameWith(info, 7.0F)}), Wall(), "steel");
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].value(3, 3), 7.0F);
  std::int64_t left = 0, right = 0;
  for (int bin = 0; bin < 400; ++bin) {
    for (int beam = 0; beam < 40; ++beam) (beam < 20 ? left : right) += frames[0].object(bin, beam);
  }
  EXPECT_GE(left, 20) << "at least one cell of every beam that meets steel";
  EXPECT_EQ(right, 0);
  EXPECT_EQ(frames[0].object(200, 19), 1) << "3 m ahead";
}

TEST(LabelledFramesTest, APoseAndTheMaterialAreNeeded) {
  const RecordingInfo info = Info("unposed");
  const MemoryRecording unposed(info, {FrameWith(info, 7.0F, false)});
  EXPECT_THROW(LabelledByScene(unposed, Wall(), "steel"), DataError);
  EXPECT_THROW(LabelledByScene(unposed, Wall(), "brass"), DataError);
}

TEST(LabelledFramesTest, MasksAreObjectFromHalfOfFullScaleOn) {
  const RecordingInfo info = Info("frames");
  const MemoryRecording recording(info, {FrameWith(info, 7.0F)});
  Frame mask = FrameWith(info, 127.0F);
  mask.image.value(5, 6) = 128.0F;
  const std::vector<metrics::LabelledFrame> frames =
      LabelledByMasks(recording, MemoryRecording(Info("masks"), {mask}));
  EXPECT_EQ(CountSet(frames.at(0).object), 1);
  EXPECT_EQ(frames[0].object(5, 6), 1);

  EXPECT_THROW(LabelledByMasks(recording, MemoryRecording(Info("masks"), {mask, mask})), DataError);
  mask.image.value = Grid<float>(400, 39);
  EXPECT_THROW(LabelledByMasks(recording, MemoryRecording(Info("masks"), {mask})), DataError);
}

}  // namespace
}  // namespace sonarcal::workflow
