// Index of an MCAP file: channels, and the positions of their messages. The layout is that of
// data_io/mcap/mcap_records.h.
//
// No size is trusted: content is compared with the file, inflated content is allocated as it is produced,
// and a file has at most one message per byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "data_io/files/compression.h"

namespace sonarcal::data_io {

struct McapChannel {
  std::string topic;
  std::string message_encoding;  // "cdr", "ros1", "json", ...
  std::string schema_name;       // "sensor_msgs/msg/Image"; empty: no schema
};

struct McapMessage {
  std::int64_t log_time_ns = 0;
  std::uint64_t container = 0;  // 0: the file itself; k: its chunk k - 1
  std::uint64_t position = 0;   // position of the record in its container
};

struct McapChunk {
  std::uint64_t offset = 0;  // position of its records in the file
  std::uint64_t packed_bytes = 0;
  std::uint64_t inflated_bytes = 0;
  std::uint32_t crc = 0;
  Codec codec = Codec::kNone;
  bool is_cut = false;  // the file ends within the chunk; packed_bytes are there
  bool has_index = false;
};

// Records of a chunk. `fault` says why they cannot be used; empty if they can. `bytes` then may hold some of
// them.
struct McapContent {
  std::vector<std::byte> bytes;
  std::string fault;
};

struct McapIndex {
  std::map<std::uint16_t, McapChannel> channels;
  std::map<std::uint16_t, std::vector<McapMessage>> messages;  // by channel
  std::vector<McapChunk> chunks;
  std::map<std::string, std::map<std::string, std::string>> metadata;  // pairs by name of the record
  std::vector<std::string> notes;  // damage and oddities, one sentence each
};

// `name` is the file's name in messages. Chunks that inflate to more than `max_chunk_bytes` are faulty.
// Throws DataError if the file does not begin as an MCAP file of version 0.
McapIndex ReadMcapIndex(const std::filesystem::path& file, const std::string& name,
                        std::uint64_t max_chunk_bytes);

// "dive.mcap: inside the chunk at byte 60".
std::string McapChunkName(const std::string& name, const McapChunk& chunk);

// Inflates a chunk and checks its size and its CRC.
McapContent ReadMcapChunk(const std::filesystem::path& file, const std::string& name, const McapChunk& chunk,
                          std::uint64_t max_chunk_bytes);

}  // namespace sonarcal::data_io
