// Writes MCAP files: chunks compressed with Zstandard, with message indices, a summary and checksums. The
// layout is that of data_io/mcap/mcap_records.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>

namespace sonarcal::data_io {

// Channel of messages of one schema.
struct McapChannelDefinition {
  std::string topic;
  std::string message_encoding;  // "cdr"
  std::string schema_name;       // "sensor_msgs/msg/Image"
  std::string schema_encoding;   // "ros2msg"
  std::string schema;
};

class McapWriter {
 public:
  // Throws DataError if the file cannot be written, as all functions below do.
  McapWriter(const std::filesystem::path& file, std::string_view profile, std::string_view library);

  // Returns the channel's id. Channels with the same schema name share the first one's schema.
  std::uint16_t AddChannel(const McapChannelDefinition& channel);

  void Write(std::uint16_t channel, std::int64_t time_ns, std::string_view data);

  // Adds pairs of names and values that belong to the file.
  void AddMetadata(std::string_view name, const std::map<std::string, std::string>& values);

  // Writes what is pending, the summary and the footer. Without it the file is cut off.
  void Close();

 private:
  struct Times {
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    std::uint64_t count = 0;

    void Add(std::uint64_t time_ns);
  };

  void Put(std::string_view bytes);
  void FlushChunk();
  std::string Statistics() const;

  std::string name_;
  std::ofstream stream_;
  std::uint64_t offset_ = 0;
  std::uint32_t crc_ = 0;  // of all bytes so far
  // The chunk that is being filled.
  std::string chunk_;
  Times chunk_times_;
  std::map<std::uint16_t, std::string> chunk_index_;
  // Content of the summary.
  std::map<std::string, std::uint16_t> schema_ids_;
  std::map<std::uint16_t, std::uint64_t> message_counts_;  // by channel
  Times times_;
  std::uint32_t chunks_ = 0;
  std::uint32_t metadata_ = 0;
  std::string schema_records_;
  std::string channel_records_;
  std::string chunk_indices_;
  std::string metadata_indices_;
};

}  // namespace sonarcal::data_io
