// MCAP files for tests, put together byte by byte after the specification, without the code that reads them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/data_io/made_up_bag.h"

namespace sonarcal::testing {

struct MadeUpMcap {
  std::string compression = {};      // of chunks: "", "lz4", "zstd", or a name that nobody knows
  std::size_t messages_a_chunk = 2;  // 0: no chunks
  bool with_index = true;            // message indices behind the chunks, and a summary
  bool with_crc = true;
  std::string message_encoding = "cdr";
};

// Places in the bytes that tests cut off or damage.
struct MadeUpMcapPlaces {
  std::vector<std::size_t> chunk;          // start of each chunk's record
  std::vector<std::size_t> chunk_records;  // start of the records in it, packed or not
  std::vector<std::size_t> message_index;  // start of each message index
  std::vector<std::size_t> bare_message;   // start of each message outside chunks
  std::size_t data_end = 0;
  std::size_t summary = 0;
  std::size_t footer = 0;
};

// The bytes of a file with these messages. Types are "package/Message".
std::string McapBytes(const std::vector<MadeUpMessage>& messages, const MadeUpMcap& how,
                      MadeUpMcapPlaces* places = nullptr);

// A record: kind, length and content.
std::string McapRecord(char kind, const std::string& content);

}  // namespace sonarcal::testing
