#include "data_io/bag_trajectory.h"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/ros/bag.h"
#include "data_io/ros/ros_messages.h"

namespace sonarcal::data_io {
namespace {

constexpr const char* kStaticTopic = "/tf_static";

bool IsTransforms(const std::string& type) {
  return type == "tf2_msgs/TFMessage" || type == "tf/tfMessage";
}

// Topic of poses of an open bag.
struct PoseTopic {
  const Bag& bag;
  std::string file;
  std::size_t index;

  const BagTopic& topic() const { return bag.topics()[index]; }
};

// Calls `take` with every pose of a topic, and with its position for messages.
void ForEachPose(const PoseTopic& from, const std::function<void(const RosPose&, const std::string&)>& take) {
  const std::string& type = from.topic().type;
  const std::vector<BagMessage> messages = from.bag.Messages(from.index);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const std::string where = fmt::format("{}: {}: message {}", from.file, Printable(from.topic().name), i);
    const std::vector<std::byte> bytes = from.bag.Read(messages[i]);
    MessageStream stream(bytes, from.topic().encoding, where);
    std::vector<RosPose> poses;
    if (IsTransforms(type)) {
      poses = ReadTransforms(stream);
    } else {
      poses.push_back(type == "nav_msgs/Odometry" ? ReadOdometry(stream) : ReadPoseStamped(stream));
    }
    for (RosPose& pose : poses) {
      if (pose.stamp_ns == 0) pose.stamp_ns = messages[i].log_time_ns;
      take(pose, where);
    }
  }
}

// Sorts by time and keeps the first pose of each time.
void Sort(std::vector<TrajectoryPose>& poses) {
  std::ranges::stable_sort(poses, {}, &TrajectoryPose::time_s);
  const auto at_one_time = [](const TrajectoryPose& a, const TrajectoryPose& b) {
    return a.time_s == b.time_s;
  };
  poses.erase(std::unique(poses.begin(), poses.end(), at_one_time), poses.end());
}

std::vector<TrajectoryPose> ReadPosesOf(const PoseTopic& from) {
  std::optional<std::pair<std::string, std::string>> frames;
  std::vector<TrajectoryPose> poses;
  ForEachPose(from, [&](const RosPose& pose, const std::string& where) {
    const std::pair these(pose.parent_frame, pose.child_frame);
    if (!frames) frames = these;
    if (*frames != these) {
      throw DataError("{}: a pose of '{}' in '{}', expected of '{}' in '{}' as before it", where,
                      Printable(these.second), Printable(these.first), Printable(frames->second),
                      Printable(frames->first));
    }
    poses.push_back({SecondsOfNs(pose.stamp_ns), CheckedPose(pose, where)});
  });
  Sort(poses);
  return poses;
}

std::string FrameName(const std::string& name) {
  return name.starts_with('/') ? name.substr(1) : name;
}

// parent_from_child of one step of a chain.
struct Link {
  std::string parent;
  std::string child;
  bool is_static = true;
  std::vector<TrajectoryPose> poses;  // a single one if static
};

// Links from the world's frame (first) to the body's.
std::vector<Link> FindChain(const std::vector<PoseTopic>& topics, const BagPoseOptions& options) {
  std::map<std::string, std::string> parent_of;
  for (const PoseTopic& from : topics) {
    ForEachPose(from, [&](const RosPose& pose, const std::string& where) {
      const std::string parent = FrameName(pose.parent_frame);
      const auto [known, is_new] = parent_of.emplace(FrameName(pose.child_frame), parent);
      if (!is_new && known->second != parent) {
        throw DataError("{}: frame '{}' has the parent '{}', expected '{}' as before", where,
                        Printable(known->first), Printable(parent), Printable(known->second));
      }
    });
  }
  const std::string world = FrameName(options.world_frame);
  std::vector<Link> chain;
  for (std::string frame = FrameName(options.body_frame); frame != world;) {
    const auto parent = parent_of.find(frame);
    // A chain with more links than frames is a cycle.
    if (parent == parent_of.end() || chain.size() > parent_of.size()) {
      throw DataError("{}: no transforms lead from '{}' to '{}', expected a chain; '{}' has no parent",
                      topics.front().file, Printable(world), Printable(FrameName(options.body_frame)),
                      Printable(frame));
    }
    chain.push_back({.parent = parent->second, .child = frame, .poses = {}});
    frame = parent->second;
  }
  std::ranges::reverse(chain);
  return chain;
}

void ReadLinks(const std::vector<PoseTopic>& topics, std::vector<Link>& chain) {
  for (const PoseTopic& from : topics) {
    const bool is_static = from.topic().name == kStaticTopic;
    ForEachPose(from, [&](const RosPose& pose, const std::string& where) {
      for (Link& link : chain) {
        if (link.child != FrameName(pose.child_frame)) continue;
        if (is_static && !link.is_static) continue;
        if (is_static || link.is_static) link.poses.clear();
        link.is_static = is_static;
        link.poses.push_back({SecondsOfNs(pose.stamp_ns), CheckedPose(pose, where)});
      }
    });
  }
  for (Link& link : chain) Sort(link.poses);
}

std::vector<TrajectoryPose> ReadChain(const std::vector<PoseTopic>& topics, const BagPoseOptions& options) {
  std::vector<Link> chain = FindChain(topics, options);
  ReadLinks(topics, chain);
  std::vector<TrajectoryPose> poses;
  for (const Link& link : chain) {
    if (!link.is_static) poses.insert(poses.end(), link.poses.begin(), link.poses.end());
  }
  if (poses.empty()) {
    throw DataError("{}: all transforms from '{}' to '{}' are static, expected one in {}",
                    topics.front().file, Printable(options.world_frame), Printable(options.body_frame),
                    topics.front().topic().name);
  }
  Sort(poses);
  std::vector<TrajectoryPose> whole;
  for (const TrajectoryPose& at : poses) {
    Pose world_from_body;
    const bool is_known = std::ranges::all_of(chain, [&](const Link& link) {
      const std::optional<Pose> step = link.is_static ? std::optional(link.poses.front().world_from_body)
                                                      : PoseAt(link.poses, at.time_s, options.most_gap_s);
      if (step) world_from_body = world_from_body * *step;
      return step.has_value();
    });
    if (is_known) whole.push_back({at.time_s, world_from_body});
  }
  return whole;
}

}  // namespace

std::vector<TrajectoryPose> ReadBagTrajectory(const std::filesystem::path& path,
                                              const BagPoseOptions& options) {
  const std::unique_ptr<Bag> bag = Bag::Open(path);
  const std::string file = path.string();
  const std::optional<std::size_t> index = bag->FindTopic(options.topic);
  if (!index) {
    throw DataError("{}: topic '{}' does not exist, expected one of poses; the bag has {}", file,
                    Printable(options.topic), DescribeTopics(bag->topics()));
  }
  const PoseTopic from{*bag, file, *index};
  const std::string& type = from.topic().type;
  std::vector<TrajectoryPose> poses;
  if (IsTransforms(type)) {
    if (options.world_frame.empty() || options.body_frame.empty()) {
      throw DataError("{}: topic '{}' has transforms between many frames, expected the names of two of them",
                      file, Printable(options.topic));
    }
    std::vector<PoseTopic> topics = {from};
    const std::optional<std::size_t> fixed = bag->FindTopic(kStaticTopic);
    if (fixed && *fixed != *index && IsTransforms(bag->topics()[*fixed].type))
      topics.push_back({*bag, file, *fixed});
    poses = ReadChain(topics, options);
  } else if (type == "nav_msgs/Odometry" || type == "geometry_msgs/PoseStamped") {
    poses = ReadPosesOf(from);
  } else {
    throw DataError(
        "{}: topic '{}' is of type {}, expected nav_msgs/Odometry, geometry_msgs/PoseStamped, "
        "tf2_msgs/TFMessage or tf/tfMessage",
        file, Printable(options.topic), Printable(type));
  }
  if (poses.empty()) {
    throw DataError("{}: topic '{}' gives no pose, expected at least one", file, Printable(options.topic));
  }
  return poses;
}

}  // namespace sonarcal::data_io
