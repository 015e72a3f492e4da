#include "tests/data_io/made_up_mcap.h"

#include <zlib.h>

#include <algorithm>
#include <map>

namespace sonarcal::testing {
namespace {

const std::string kMagic{"\x89MCAP0\r\n", 8};

std::string Little(std::uint64_t value, std::size_t size) {
  std::string bytes;
  for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(value >> 8 * i);
  return bytes;
}
std::string U16(std::uint64_t value) {
  return Little(value, 2);
}
std::string U32(std::uint64_t value) {
  return Little(value, 4);
}
std::string U64(std::uint64_t value) {
  return Little(value, 8);
}
std::string Text(const std::string& text) {
  return U32(text.size()) + text;
}

std::uint32_t Crc(const std::string& bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

struct Definitions {
  std::map<std::string, int> schema_ids;   // by type
  std::map<std::string, int> channel_ids;  // by topic
  std::string schemas;
  std::string channels;

  // Records that must stand before the first message of a topic; empty for a topic that is known.
  std::string Of(const MadeUpMessage& message, const std::string& encoding) {
    std::string records;
    if (!schema_ids.contains(message.type)) {
      const int id = static_cast<int>(schema_ids.size()) + 1;
      schema_ids[message.type] = id;
      std::string type = message.type;
      if (encoding == "cdr") type.replace(type.find('/'), 1, "/msg/");
      records += McapRecord(3, U16(id) + Text(type) + Text(encoding == "cdr" ? "ros2msg" : "ros1msg") +
                                   Text("uint8 of_no_matter\n"));
      schemas += records;
    }
    if (!channel_ids.contains(message.topic)) {
      const int id = static_cast<int>(channel_ids.size()) + 7;
      channel_ids[message.topic] = id;
      const std::string metadata = Text("offered_qos_profiles") + Text("");
      const std::string channel =
          McapRecord(4, U16(id) + U16(schema_ids[message.type]) + Text(message.topic) + Text(encoding) +
                            U32(metadata.size()) + metadata);
      channels += channel;
      records += channel;
    }
    return records;
  }
};

std::string MessageRecord(const MadeUpMessage& message, int channel) {
  return McapRecord(
      5, U16(channel) + U32(0) + U64(message.log_time_ns) + U64(message.log_time_ns) + message.bytes);
}

}  // namespace

std::string McapRecord(char kind, const std::string& content) {
  std::string record(1, kind);
  record += U64(content.size());
  record += content;
  return record;
}

std::string McapBytes(const std::vector<MadeUpMessage>& messages, const MadeUpMcap& how,
                      MadeUpMcapPlaces* places) {
  MadeUpMcapPlaces scratch;
  MadeUpMcapPlaces& at = places == nullptr ? scratch : *places;
  at = {};
  Definitions definitions;
  std::string file = kMagic + McapRecord(1, Text("ros2") + Text("a test"));
  std::string chunk_indices;
  for (std::size_t first = 0; first < messages.size();
       first += std::max<std::size_t>(1, how.messages_a_chunk)) {
    if (how.messages_a_chunk == 0) {
      file += definitions.Of(messages[first], how.message_encoding);
      at.bare_message.push_back(file.size());
      file += MessageRecord(messages[first], definitions.channel_ids[messages[first].topic]);
      continue;
    }
    std::string records;
    std::map<int, std::string> index;  // by channel
    const std::size_t end = std::min(messages.size(), first + how.messages_a_chunk);
    for (std::size_t i = first; i < end; ++i) {
      records += definitions.Of(messages[i], how.message_encoding);
      const int channel = definitions.channel_ids[messages[i].topic];
      index[channel] += U64(messages[i].log_time_ns) + U64(records.size());
      records += MessageRecord(messages[i], channel);
    }
    const std::string packed = PackedBytes(records, how.compression);
    const std::string times = U64(messages[first].log_time_ns) + U64(messages[end - 1].log_time_ns);
    const std::string chunk =
        McapRecord(6, times + U64(records.size()) + U32(how.with_crc ? Crc(records) : 0) +
                          Text(how.compression) + U64(packed.size()) + packed);
    const std::size_t chunk_at = file.size();
    at.chunk.push_back(chunk_at);
    file += chunk;
    at.chunk_records.push_back(file.size() - packed.size());
    if (!how.with_index) continue;
    std::string offsets;
    const std::size_t indices_at = file.size();
    for (const auto& [channel, entries] : index) {
      at.message_index.push_back(file.size());
      offsets += U16(channel) + U64(file.size());
      file += McapRecord(7, U16(channel) + U32(entries.size()) + entries);
    }
    chunk_indices += McapRecord(8, times + U64(chunk_at) + U64(chunk.size()) + U32(offsets.size()) + offsets +
                                       U64(file.size() - indices_at) + Text(how.compression) +
                                       U64(packed.size()) + U64(records.size()));
  }
  at.data_end = file.size();
  file += McapRecord(15, U32(how.with_crc ? Crc(file) : 0));
  at.summary = how.with_index ? file.size() : 0;
  if (how.with_index) {
    file += definitions.schemas + definitions.channels;
    file += McapRecord(11, U64(messages.size()) + U16(definitions.schema_ids.size()) +
                               U32(definitions.channel_ids.size()) + U32(0) + U32(0) + U32(at.chunk.size()) +
                               U64(0) + U64(0) + U32(0));
    file += chunk_indices;
  }
  at.footer = file.size();
  std::string footer = McapRecord(2, U64(at.summary) + U64(0) + U32(0));
  if (how.with_crc && how.with_index) {
    const std::string summed = file.substr(at.summary) + footer.substr(0, footer.size() - 4);
    footer.replace(footer.size() - 4, 4, U32(Crc(summed)));
  }
  return file + footer + kMagic;
}

}  // namespace sonarcal::testing
