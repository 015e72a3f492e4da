// Writes bags of ROS 1: chunks compressed with LZ4, with message indices, connections and chunk infos. The
// layout is that of data_io/ros/ros1_records.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>

namespace sonarcal::data_io {

// Messages of one type on one topic. `definition` is the text of the message and of those it contains.
struct Ros1Connection {
  std::string topic;
  std::string type;  // "sensor_msgs/Image"
  std::string md5;   // of the definition
  std::string definition;
};

class Ros1BagFile {
 public:
  // Throws DataError if the file cannot be written, as all functions below do.
  explicit Ros1BagFile(const std::filesystem::path& file);

  // Returns the connection's id.
  std::uint32_t AddConnection(const Ros1Connection& connection);

  void Write(std::uint32_t connection, std::int64_t time_ns, std::string_view message);

  // Writes what is pending, the connections and the chunk infos. Without it the file is cut off.
  void Close();

 private:
  struct Index {
    std::uint32_t count = 0;
    std::string entries;
  };

  void Put(std::string_view bytes);
  void PutBagHeader(std::uint64_t index_at);
  void FlushChunk();

  std::string name_;
  std::ofstream stream_;
  std::uint64_t offset_ = 0;
  // The chunk that is being filled.
  std::string chunk_;
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::map<std::uint32_t, Index> index_;  // by connection
  // Content of the records after the chunks.
  std::uint32_t connections_ = 0;
  std::uint32_t chunks_ = 0;
  std::string connection_records_;
  std::string chunk_infos_;
};

}  // namespace sonarcal::data_io
