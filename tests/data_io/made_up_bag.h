// Bags of both kinds for tests, made from serialised messages without the code that reads them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sonarcal::testing {

inline constexpr const char* kProjectedType = "marine_acoustic_msgs/ProjectedSonarImage";

struct MadeUpMessage {
  std::string topic;
  std::string type;  // "package/Message"
  std::int64_t log_time_ns = 0;
  std::string bytes;
};

// Bytes as one frame or stream: "lz4", "zstd", "bz2", or anything else for the bytes themselves.
std::string PackedBytes(const std::string& bytes, const std::string& compression);

struct MadeUpRos1Bag {
  std::string compression = "none";
  std::size_t messages_a_chunk = 2;
  bool with_end = true;  // connections and chunk infos, which a recording that was cut off has not
  bool encrypted = false;
};

// The bytes of a ROS 1 bag, format 2.0.
std::string Ros1BagBytes(const std::vector<MadeUpMessage>& messages, const MadeUpRos1Bag& bag);

// Writes the tables of rosbag2 to `file`, with small pages so that tests reach many of them. Runs
// `more_sql` at the end.
void WriteRos2Bag(const std::filesystem::path& file, const std::vector<MadeUpMessage>& messages,
                  const std::string& more_sql = "");

}  // namespace sonarcal::testing
