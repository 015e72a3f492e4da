#include "core/math/pose_groups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace sonarcal {
namespace {

using ::testing::ElementsAre;

TEST(PoseGroups, AreThoseThatComparisonsOfAllPairsGive) {
  std::vector<Pose> poses;
  for (int i = 0; i < 300; ++i) {
    const double angle_rad = 2e-3 * (i * 7 % 30);
    poses.push_back({RotationFromYawPitchRoll(angle_rad, 0.3 * angle_rad, 0.0),
                     {0.5e-3 * (i % 11), -0.4e-3 * (i % 5), 1.0}});
  }
  std::vector<std::vector<int>> slow;
  for (int i = 0; i < 300; ++i) {
    const auto same = std::ranges::find_if(
        slow, [&](const std::vector<int>& group) { return IsSamePose(poses[group.front()], poses[i]); });
    if (same == slow.end()) {
      slow.push_back({i});
    } else {
      same->push_back(i);
    }
  }
  EXPECT_EQ(GroupByPose(poses), slow);
  EXPECT_LT(slow.size(), poses.size());
}

// Each pose is the same as the one before it, within a millimetre.
TEST(PoseGroups, ASlowMotionStartsNewGroups) {
  std::vector<Pose> poses;
  for (int i = 0; i < 7; ++i) poses.push_back({Eigen::Quaterniond::Identity(), {0.9e-3 * i, 0.0, 0.0}});
  EXPECT_THAT(FirstOfPose(poses), ElementsAre(0, 0, 2, 2, 4, 4, 6));
  EXPECT_TRUE(FirstOfPose({}).empty());
}

}  // namespace
}  // namespace sonarcal
