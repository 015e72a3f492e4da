// A ROS bag of either kind: its topics, and the serialised messages of one of them, read one at a time.
//
// Bag::Open tells ROS 1 bags (data_io/ros/ros1_bag.h) from ROS 2 bags (data_io/ros/ros2_bag.h) by their
// content.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "data_io/ros/message_stream.h"

namespace sonarcal::data_io {

// No message, and no chunk of a ROS 1 bag once inflated, is read that is larger.
inline constexpr std::uint64_t kMostBagMessageBytes = 256 << 20;

struct BagTopic {
  std::string name;  // "/sonar"
  std::string type;  // "sensor_msgs/Image", for ROS 2 as well
  std::uint64_t count = 0;
};

// Where a message lies in its bag.
struct BagMessage {
  std::int64_t log_time_ns = 0;  // when it was recorded
  std::uint64_t container = 0;   // chunk or file of the bag
  std::int64_t position = 0;     // in it

  bool operator<(const BagMessage& other) const {
    if (log_time_ns != other.log_time_ns) return log_time_ns < other.log_time_ns;
    return container != other.container ? container < other.container : position < other.position;
  }
};

class Bag {
 public:
  virtual ~Bag() = default;

  // Throws DataError where `path` is no bag, or one that cannot be read.
  static std::unique_ptr<Bag> Open(const std::filesystem::path& path);

  virtual std::string format() const = 0;  // "ROS 1 bag"
  virtual MessageEncoding encoding() const = 0;
  virtual const std::vector<BagTopic>& topics() const = 0;
  virtual const std::vector<std::string>& notes() const = 0;  // what was left out, one sentence each

  // Messages of topics()[topic], by the time they were recorded.
  virtual std::vector<BagMessage> Messages(std::size_t topic) const = 0;

  // The first bytes of a message, all of it where it is shorter. Throws DataError where it is damaged, or
  // longer than kMostBagMessageBytes.
  virtual std::vector<std::byte> Read(
      const BagMessage& message,
      std::uint64_t wanted_bytes = std::numeric_limits<std::uint64_t>::max()) const = 0;

  // Index of the topic of that name.
  std::optional<std::size_t> FindTopic(const std::string& name) const;
};

// True where the path is a bag of either kind.
bool IsBag(const std::filesystem::path& path);

// "/sonar (sensor_msgs/Image, 12 messages), ...": for messages and notes.
std::string DescribeTopics(const std::vector<BagTopic>& topics);

// "sensor_msgs/Image" of "sensor_msgs/msg/Image".
std::string Ros1TypeName(const std::string& type);

}  // namespace sonarcal::data_io
