// Messages of an MCAP file, read one at a time. The layout is that of data_io/mcap/mcap_records.h.
//
// The file is read from its start, so an index is used but not required, and a file that was cut off is read
// as far as it goes. An incomplete message, and a message in a damaged chunk, are listed, and
// refused when they are read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "data_io/mcap/mcap_index.h"

namespace sonarcal::data_io {

class McapFile {
 public:
  // `name` is the file's name in messages. Messages and inflated chunks of more than `max_message_bytes` are
  // refused when they are read. Throws DataError if the file does not begin as an MCAP file of version 0.
  McapFile(std::filesystem::path file, std::string name, std::uint64_t max_message_bytes);

  const std::map<std::uint16_t, McapChannel>& channels() const { return index_.channels; }
  const std::vector<std::string>& notes() const { return index_.notes; }
  const std::map<std::string, std::map<std::string, std::string>>& metadata() const {
    return index_.metadata;
  }

  // Messages by channel, in the order of the file. Moves them out of the object.
  std::map<std::uint16_t, std::vector<McapMessage>> TakeMessages() { return std::move(index_.messages); }

  // First `wanted_bytes` of a message's data, or all of it if it is shorter. Throws DataError if the message,
  // or the chunk that contains it, is damaged or not whole.
  std::vector<std::byte> Read(const McapMessage& message,
                              std::uint64_t wanted_bytes = std::numeric_limits<std::uint64_t>::max()) const;

 private:
  std::shared_ptr<const McapContent> ContentOf(std::uint64_t chunk) const;
  std::uint64_t DataBytes(const McapMessage& message, const class ByteReader& head,
                          std::uint64_t rest_bytes) const;

  std::filesystem::path file_;
  std::string name_;
  std::uint64_t file_bytes_;
  std::uint64_t max_message_bytes_;
  McapIndex index_;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const McapContent> content_;  // of the last chunk: messages are read in order
  mutable std::uint64_t content_chunk_ = 0;
};

}  // namespace sonarcal::data_io
