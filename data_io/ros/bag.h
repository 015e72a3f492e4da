// ROS bag of any kind: its topics, and the serialised messages of one of them, read one at a time.
//
// Bag::Open distinguishes ROS 1 bags (data_io/ros/ros1_bag.h) and ROS 2 bags in SQLite storage
// (data_io/ros/ros2_bag.h) or MCAP storage (data_io/ros/mcap_bag.h) by their content.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "data_io/ros/message_stream.h"

namespace sonarcal::data_io {

// Max size of a message, and of an inflated chunk.
inline constexpr std::uint64_t kMaxBagMessageBytes = 256 << 20;

struct BagTopic {
  std::string name;  // "/sonar"
  std::string type;  // "sensor_msgs/Image", also for ROS 2
  std::uint64_t count = 0;
  MessageEncoding encoding = MessageEncoding::kRos1;
};

// Position of a message in its bag.
struct BagMessage {
  std::int64_t log_time_ns = 0;  // time of recording
  std::uint64_t container = 0;   // chunk or file of the bag
  std::int64_t position = 0;     // position in the container

  bool operator<(const BagMessage& other) const {
    if (log_time_ns != other.log_time_ns) return log_time_ns < other.log_time_ns;
    return container != other.container ? container < other.container : position < other.position;
  }
};

class Bag {
 public:
  virtual ~Bag() = default;

  // Throws DataError if `path` is no bag, or cannot be read.
  static std::unique_ptr<Bag> Open(const std::filesystem::path& path);

  virtual std::string format() const = 0;  // "ROS 1 bag"
  virtual const std::vector<BagTopic>& topics() const = 0;
  virtual const std::vector<std::string>& notes() const = 0;  // omitted parts of the bag, one sentence each

  // recording.json without frames, which the writers of data_io/bag_writers store beside the messages; empty
  // if the bag has none.
  virtual std::string recording_json() const { return {}; }

  // Messages of topics()[topic], in order of their time of recording.
  virtual std::vector<BagMessage> Messages(std::size_t topic) const = 0;

  // First `wanted_bytes` of a message, or all of it if it is shorter. Throws DataError if it is damaged, or
  // longer than kMaxBagMessageBytes.
  virtual std::vector<std::byte> Read(
      const BagMessage& message,
      std::uint64_t wanted_bytes = std::numeric_limits<std::uint64_t>::max()) const = 0;

  // Index of the topic with this name.
  std::optional<std::size_t> FindTopic(const std::string& name) const;
};

// Bytes of a message of ROS 2. rosbag2 can store each message as a Zstandard frame (compression mode
// "message"); these are inflated. `stored` holds at least the first min(wanted_bytes, all) bytes of the
// message, `read_all` returns all of them. Throws DataError, beginning with `where`, if the frame is damaged.
std::vector<std::byte> InflatedMessage(std::vector<std::byte> stored, std::uint64_t wanted_bytes,
                                       const std::function<std::vector<std::byte>()>& read_all,
                                       const std::string& where);

// True if the path is a bag of any kind.
bool IsBag(const std::filesystem::path& path);

// Text for messages and notes: "/sonar (sensor_msgs/Image, 12 messages), ...".
std::string DescribeTopics(const std::vector<BagTopic>& topics);

// Converts "sensor_msgs/msg/Image" to "sensor_msgs/Image".
std::string Ros1TypeName(const std::string& type);

}  // namespace sonarcal::data_io
