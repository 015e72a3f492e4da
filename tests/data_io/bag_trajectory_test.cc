#include "data_io/bag_trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "core/types/error.h"
#include "tests/data_io/made_up_bag.h"
#include "tests/data_io/message_writer.h"
#include "tests/data_io/refusal.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using ::testing::HasSubstr;
using testing::MadeUpMessage;
using testing::MessageWriter;
using testing::Wire;

constexpr double kHalf = std::numbers::sqrt2 / 2.0;  // sine and cosine of 45 degrees: a quarter turn

void Put(MessageWriter& message, const Pose& pose) {
  message.F64(pose.position_m.x()).F64(pose.position_m.y()).F64(pose.position_m.z());
  message.F64(pose.rotation.x()).F64(pose.rotation.y()).F64(pose.rotation.z()).F64(pose.rotation.w());
}

std::string Odometry(Wire wire, std::uint32_t seconds, const Pose& pose, const std::string& world = "odom") {
  MessageWriter message(wire);
  message.Header(seconds, 500'000'000, world).String("base_link");
  Put(message, pose);
  for (int i = 0; i < 36 + 6 + 36; ++i) message.F64(i);
  return message.bytes();
}

std::string PoseStamped(Wire wire, std::uint32_t seconds, const Pose& pose) {
  MessageWriter message(wire);
  message.Header(seconds, 0, "map");
  Put(message, pose);
  return message.bytes();
}

struct Transform {
  std::uint32_t seconds;
  std::string parent;
  std::string child;
  Pose pose;
};

std::string Transforms(Wire wire, const std::vector<Transform>& transforms) {
  MessageWriter message(wire);
  message.U32(static_cast<std::uint32_t>(transforms.size()));
  for (const Transform& transform : transforms) {
    message.Header(transform.seconds, 0, transform.parent).String(transform.child);
    Put(message, transform.pose);
  }
  return message.bytes();
}

Pose At(double x_m, double y_m, double z_m) {
  return {Eigen::Quaterniond::Identity(), {x_m, y_m, z_m}};
}
const Pose kQuarterTurnAboutZ = {Eigen::Quaterniond(kHalf, 0.0, 0.0, kHalf), {0.0, 0.0, 0.0}};

class BagTrajectoryTest : public ::testing::Test {
 protected:
  std::filesystem::path Write(Wire wire, const std::vector<MadeUpMessage>& messages) {
    std::filesystem::path path = dir_ / (wire == Wire::kRos1 ? "test.bag" : "test.db3");
    if (wire == Wire::kRos1) {
      testing::WriteFile(path, testing::Ros1BagBytes(messages, {.compression = "lz4"}));
    } else {
      testing::WriteRos2Bag(path, messages);
    }
    return path;
  }
  std::string Refusal(const std::vector<MadeUpMessage>& messages, const BagPoseOptions& options) {
    const auto path = Write(Wire::kRos1, messages);
    return testing::MessageOf([&] { ReadBagTrajectory(path, options); });
  }

  testing::TempDir dir_;
};

TEST_F(BagTrajectoryTest, OdometryAndStampedPosesAreReadInOrderOfTheirTimes) {
  for (const Wire wire : testing::kWires) {
    Pose turned = kQuarterTurnAboutZ;
    turned.position_m = {1.0, 2.0, -3.0};
    const auto path =
        Write(wire, {{"/odom", "nav_msgs/Odometry", 1, Odometry(wire, 20, turned)},
                     {"/odom", "nav_msgs/Odometry", 2, Odometry(wire, 10, At(4.0, 5.0, 6.0))},
                     {"/odom", "nav_msgs/Odometry", 3, Odometry(wire, 20, At(9.0, 9.0, 9.0))},
                     {"/pose", "geometry_msgs/PoseStamped", 7'000'000'000, PoseStamped(wire, 0, turned)}});
    const auto odom = ReadBagTrajectory(path, {.topic = "/odom"});
    ASSERT_EQ(odom.size(), 2U);  // of two at one time the first
    EXPECT_EQ(odom[0].time_s, 10.5);
    EXPECT_EQ(odom[0].world_from_body.position_m, Eigen::Vector3d(4.0, 5.0, 6.0));
    EXPECT_EQ(odom[1].time_s, 20.5);
    EXPECT_EQ(odom[1].world_from_body.position_m, Eigen::Vector3d(1.0, 2.0, -3.0));
    // A quarter turn about Z takes X to Y.
    EXPECT_LT((odom[1].world_from_body.rotation * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(),
              1e-9);
    const auto pose = ReadBagTrajectory(path, {.topic = "/pose"});
    ASSERT_EQ(pose.size(), 1U);
    EXPECT_EQ(pose[0].time_s, 7.0);  // no stamp: when it was recorded
  }
}

// The body moves along X of a map that is itself turned by a quarter in the world; the sonar sits 1 m ahead
// of the body. By hand: sonar in world = turn * (x + 1, 0, 0) = (0, x + 1, 0).
TEST_F(BagTrajectoryTest, AChainOfTransformsIsFollowedStaticOnesIncluded) {
  for (const Wire wire : testing::kWires) {
    const auto path = Write(
        wire, {{"/tf_static", "tf2_msgs/TFMessage", 1,
                Transforms(wire, {{0, "/body", "/sonar", At(1.0, 0.0, 0.0)},
                                  {0, "world", "map", kQuarterTurnAboutZ}})},
               {"/tf", "tf2_msgs/TFMessage", 2,
                Transforms(wire, {{10, "map", "body", At(0.0, 0.0, 0.0)},
                                  {10, "world", "other", At(8.0, 8.0, 8.0)}})},
               {"/tf", "tf2_msgs/TFMessage", 3, Transforms(wire, {{12, "map", "body", At(4.0, 0.0, 0.0)}})}});
    const auto poses =
        ReadBagTrajectory(path, {.topic = "/tf", .world_frame = "world", .body_frame = "sonar"});
    ASSERT_EQ(poses.size(), 2U);
    EXPECT_EQ(poses[1].time_s, 12.0);
    EXPECT_LT((poses[0].world_from_body.position_m - Eigen::Vector3d(0.0, 1.0, 0.0)).norm(), 1e-9);
    EXPECT_LT((poses[1].world_from_body.position_m - Eigen::Vector3d(0.0, 5.0, 0.0)).norm(), 1e-9);
  }
}

// Two links that are sent at different times: each is interpolated where only the other was sent.
TEST_F(BagTrajectoryTest, LinksOfAChainAreInterpolated) {
  std::vector<MadeUpMessage> messages;
  for (const std::uint32_t time : {10U, 12U}) {
    messages.push_back({"/tf", "tf/tfMessage", time,
                        Transforms(Wire::kRos1, {{time, "world", "body", At(time, 0.0, 0.0)}})});
  }
  for (const std::uint32_t time : {11U, 20U}) {
    messages.push_back(
        {"/tf", "tf/tfMessage", time, Transforms(Wire::kRos1, {{time, "body", "pan", At(0.0, time, 0.0)}})});
  }
  BagPoseOptions options{.topic = "/tf", .world_frame = "world", .body_frame = "pan", .most_gap_s = 9.0};
  const auto path = Write(Wire::kRos1, messages);
  const auto poses = ReadBagTrajectory(path, options);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[0].time_s, 11.0);
  EXPECT_LT((poses[0].world_from_body.position_m - Eigen::Vector3d(11.0, 11.0, 0.0)).norm(), 1e-9);
  EXPECT_EQ(poses[1].time_s, 12.0);
  EXPECT_LT((poses[1].world_from_body.position_m - Eigen::Vector3d(12.0, 12.0, 0.0)).norm(), 1e-9);
  options.most_gap_s = 1.0;
  EXPECT_THAT(testing::MessageOf([&] { ReadBagTrajectory(path, options); }), HasSubstr("gives no pose"));
}

TEST_F(BagTrajectoryTest, TopicsWithoutPosesAreRefused) {
  const MadeUpMessage image{"/image", "sensor_msgs/Image", 1, "?"};
  EXPECT_THAT(Refusal({image}, {.topic = "/odom"}), HasSubstr("topic '/odom' does not exist"));
  EXPECT_THAT(Refusal({image}, {.topic = "/image"}),
              HasSubstr("of type sensor_msgs/Image, expected nav_msgs"));
  const auto odometry = [](const std::string& bytes) {
    return MadeUpMessage{"/odom", "nav_msgs/Odometry", 1, bytes};
  };
  Pose longer = At(0.0, 0.0, 0.0);
  longer.rotation.w() = 1.01;
  EXPECT_THAT(Refusal({odometry(Odometry(Wire::kRos1, 1, longer))}, {.topic = "/odom"}),
              HasSubstr("a quaternion of length 1.01, expected 1"));
  EXPECT_THAT(Refusal({odometry(Odometry(Wire::kRos1, 1, At(NAN, 0.0, 0.0)))}, {.topic = "/odom"}),
              HasSubstr("expected finite numbers"));
  EXPECT_THAT(Refusal({odometry(Odometry(Wire::kRos1, 1, At(0.0, 0.0, 0.0))),
                       odometry(Odometry(Wire::kRos1, 2, At(0.0, 0.0, 0.0), "map"))},
                      {.topic = "/odom"}),
              HasSubstr("a pose of 'base_link' in 'map', expected of 'base_link' in 'odom'"));
}

TEST_F(BagTrajectoryTest, TransformsThatAreNoChainAreRefused) {
  const auto tf = [](const std::vector<Transform>& transforms) {
    return MadeUpMessage{"/tf", "tf2_msgs/TFMessage", 1, Transforms(Wire::kRos1, transforms)};
  };
  const Pose none;
  const BagPoseOptions options{.topic = "/tf", .world_frame = "world", .body_frame = "sonar"};
  EXPECT_THAT(Refusal({tf({{1, "map", "sonar", none}})}, {.topic = "/tf"}),
              HasSubstr("the names of two of them"));
  EXPECT_THAT(Refusal({tf({{1, "map", "sonar", none}})}, options),
              HasSubstr("no transforms lead from 'world' to 'sonar', expected a chain; 'map' has no parent"));
  EXPECT_THAT(Refusal({tf({{1, "a", "sonar", none}, {1, "sonar", "a", none}})}, options),
              HasSubstr("no transforms lead"));
  EXPECT_THAT(Refusal({tf({{1, "a", "sonar", none}, {2, "b", "sonar", none}})}, options),
              HasSubstr("frame 'sonar' has the parent 'b', expected 'a'"));
}

}  // namespace
}  // namespace sonarcal::data_io
