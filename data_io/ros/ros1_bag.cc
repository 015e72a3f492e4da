#include "data_io/ros/ros1_bag.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/files/byte_reader.h"
#include "data_io/files/compression.h"
#include "data_io/ros/ros1_records.h"
#include "data_io/ros/ros_messages.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kIndexEntryBytes = 12;
constexpr std::uint64_t kMaxHeaderBytes = 1 << 16;       // a topic's name and a hundred bytes
constexpr std::uint64_t kMaxConnectionBytes = 16 << 20;  // message definitions are long

// Fields "name=value", each after its u32 length. The bytes must outlive it.
class Fields {
 public:
  // Throws DataError for a length that leads out of `bytes` and for a field without '='.
  explicit Fields(const ByteReader& bytes) : where_(bytes.Where(0, "header of a record")) {
    for (std::uint64_t at = 0; at < bytes.size();) {
      const std::uint32_t length = bytes.U32(at, "length of a field");
      const std::span<const std::byte> field = bytes.Bytes(at + 4, length, "field");
      const auto equals = std::ranges::find(field, std::byte{'='});
      if (equals == field.end()) {
        throw DataError("{}: no '=' in it, expected name=value", bytes.Where(at + 4, "field"));
      }
      const auto name_bytes = static_cast<std::size_t>(equals - field.begin());
      values_.emplace(TextOf(field.first(name_bytes)),
                      ByteReader(field.subspan(name_bytes + 1), bytes.file(), bytes.file_offset()));
      at += 4 + std::uint64_t{length};
    }
  }

  // Throws DataError for a value that is missing or too short.
  std::uint8_t U8(const std::string& name) const { return Value(name).U8(0, name); }
  std::uint32_t U32(const std::string& name) const { return Value(name).U32(0, name); }
  std::string Text(const std::string& name) const {
    return TextOf(Value(name).Bytes(0, Value(name).size(), name));
  }
  bool Has(const std::string& name) const { return values_.contains(name); }

 private:
  static std::string TextOf(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  const ByteReader& Value(const std::string& name) const {
    const auto found = values_.find(name);
    if (found == values_.end()) throw DataError("{}: no field '{}', expected one", where_, name);
    return found->second;
  }

  std::string where_;
  std::map<std::string, ByteReader> values_;
};

struct Record {
  Ros1Op op;
  Fields fields;
  std::uint64_t data_at = 0;  // position in the reader that parsed the record
  std::uint64_t data_bytes = 0;

  std::uint64_t end() const { return data_at + data_bytes; }
};

// Parses the record at `at`. The reader holds at least its header. Its data lie within the `rest` bytes from
// `at` to the end of its container.
Record ParseRecord(const ByteReader& reader, std::uint64_t at, std::uint64_t rest) {
  const std::uint32_t header_bytes = reader.U32(at, "length of a header");
  if (header_bytes > std::min(kMaxHeaderBytes, rest)) {
    throw DataError("{}: {}, expected at most {}", reader.Where(at, "length of a header"), header_bytes,
                    std::min(kMaxHeaderBytes, rest));
  }
  Fields fields({reader.Bytes(at + 4, header_bytes, "header of a record"), reader.file(),
                 reader.file_offset() + at + 4});
  const std::uint64_t length_at = at + 4 + header_bytes;
  const std::uint32_t data_bytes = reader.U32(length_at, "length of the data");
  const std::uint64_t head_bytes = length_at + 4 - at;
  if (head_bytes > rest || data_bytes > rest - head_bytes) {
    throw DataError("{}: {}, of which {} are there", reader.Where(length_at, "length of the data"),
                    data_bytes, rest - std::min(rest, head_bytes));
  }
  const auto op = static_cast<Ros1Op>(fields.U8("op"));
  return {op, std::move(fields), length_at + 4, data_bytes};
}

// Bytes read to get a record's header: enough for almost all records.
constexpr std::uint64_t kFirstLook = 512;

// Bytes of the file from `offset` that hold a whole record header and the length after it, at most `rest`.
std::vector<std::byte> HeadBytes(const fs::path& file, std::uint64_t offset, std::uint64_t rest) {
  std::vector<std::byte> bytes = ReadFileRange(file, offset, std::min(rest, kFirstLook), "record");
  const std::uint64_t needed =
      ByteReader(bytes, file.string(), offset).U32(0, "length of a header") + std::uint64_t{8};
  if (needed <= bytes.size() || needed > std::min(rest, kMaxHeaderBytes)) return bytes;
  return ReadFileRange(file, offset, needed, "record");
}

struct Chunk {
  std::uint64_t data_offset = 0;  // position in the file
  std::uint64_t data_bytes = 0;
  Codec compression = Codec::kNone;
  std::uint32_t inflated_bytes = 0;
  bool has_index = false;
};

struct Connection {
  std::string topic;
  std::string type;
};

Codec CompressionOf(const std::string& name, const std::string& where) {
  if (name == "none") return Codec::kNone;
  if (name == "bz2") return Codec::kBzip2;
  if (name == "lz4") return Codec::kLz4;
  throw DataError("{}: compression '{}', expected none, bz2 or lz4", where, Printable(name));
}

// Inflated bytes of a chunk. Throws DataError if they are damaged.
std::vector<std::byte> InflatedBytes(const Chunk& chunk, std::span<const std::byte> packed,
                                     const std::string& where) {
  Inflated inflated = Inflate(chunk.compression, packed, chunk.inflated_bytes);
  if (inflated.end == Inflated::End::kDamaged)
    throw DataError("{}: the compressed chunk is damaged: {}", where, inflated.fault);
  if (inflated.end != Inflated::End::kWhole || inflated.bytes.size() != chunk.inflated_bytes) {
    throw DataError("{}: the compressed chunk is damaged: {} {} bytes, expected {}", where,
                    inflated.end == Inflated::End::kMore ? "more than" : "only", inflated.bytes.size(),
                    chunk.inflated_bytes);
  }
  return std::move(inflated.bytes);
}

class Ros1Bag final : public Bag {
 public:
  explicit Ros1Bag(const fs::path& path) : file_(path), file_bytes_(RegularFileSize(path)) {
    const std::vector<std::byte> magic =
        FileBytes(0, std::min<std::uint64_t>(file_bytes_, kRos1Magic.size()), "magic number");
    const std::string_view found(reinterpret_cast<const char*>(magic.data()), magic.size());
    if (found != kRos1Magic) {
      throw DataError("{}: byte 0: '{}', expected \"#ROSBAG V2.0\" and a line's end", name(),
                      Printable(found));
    }
    Walk();
    FindMissingConnections();
    ListTopics();
  }

  std::string format() const override { return "ROS 1 bag"; }
  const std::vector<BagTopic>& topics() const override { return topics_; }
  const std::vector<std::string>& notes() const override { return notes_; }

  std::vector<BagMessage> Messages(std::size_t topic) const override {
    std::vector<BagMessage> messages;
    for (const auto& [id, connection] : connections_) {
      const auto found = messages_.find(id);
      if (found == messages_.end() || connection.topic != topics_.at(topic).name ||
          connection.type != topics_.at(topic).type) {
        continue;
      }
      messages.insert(messages.end(), found->second.begin(), found->second.end());
    }
    std::sort(messages.begin(), messages.end());
    return messages;
  }

  std::vector<std::byte> Read(const BagMessage& message, std::uint64_t wanted_bytes) const override {
    const Chunk& chunk = chunks_.at(message.container);
    const auto at = static_cast<std::uint64_t>(message.position);
    if (chunk.compression == Codec::kNone) {
      const std::uint64_t offset = chunk.data_offset + at;
      const std::uint64_t rest = chunk.data_bytes - at;
      const std::vector<std::byte> head = HeadBytes(file_, offset, rest);
      const Record record = ParseRecord({head, name(), offset}, 0, rest);
      CheckMessage(record, offset);
      return FileBytes(offset + record.data_at, std::min(record.data_bytes, wanted_bytes), "message");
    }
    const std::shared_ptr<const std::vector<std::byte>> bytes = Inflated(message.container);
    const ByteReader reader(*bytes, ChunkName(chunk));
    const Record record = ParseRecord(reader, at, bytes->size() - at);
    CheckMessage(record, at);
    const auto data = reader.Bytes(record.data_at, std::min(record.data_bytes, wanted_bytes), "message");
    return {data.begin(), data.end()};
  }

 private:
  std::string name() const { return file_.string(); }

  std::vector<std::byte> FileBytes(std::uint64_t offset, std::uint64_t count, std::string_view what) const {
    return ReadFileRange(file_, offset, count, what);
  }

  void CheckMessage(const Record& record, std::uint64_t at) const {
    if (record.op == Ros1Op::kMessage && record.data_bytes <= kMaxBagMessageBytes) return;
    throw DataError("{}: byte {}: record of kind {} and {} bytes, expected a message of at most {}", name(),
                    at, static_cast<int>(record.op), record.data_bytes, kMaxBagMessageBytes);
  }

  // Reads the headers of all records.
  void Walk() {
    std::uint64_t offset = kRos1Magic.size();
    while (offset < file_bytes_) {
      const std::uint64_t rest = file_bytes_ - offset;
      try {
        const std::vector<std::byte> head = HeadBytes(file_, offset, rest);
        const Record record = ParseRecord({head, name(), offset}, 0, rest);
        Take(record, offset);
        offset += record.end();
      } catch (const DataError& error) {
        notes_.push_back(
            fmt::format("The {} bytes from byte {} on are no whole record and were left out: {}.", rest,
                        offset, error.what()));
        break;
      }
      if (is_encrypted_) throw DataError("{}: the bag is encrypted and cannot be read", name());
    }
    const auto without = std::ranges::count_if(chunks_, [](const Chunk& chunk) { return !chunk.has_index; });
    if (without > 0) {
      notes_.push_back(fmt::format("{} {} no index behind {} and {} left out.", without,
                                   without == 1 ? "chunk has" : "chunks have", without == 1 ? "it" : "them",
                                   without == 1 ? "was" : "were"));
    }
  }

  void Take(const Record& record, std::uint64_t offset) {
    const std::string where = fmt::format("{}: byte {}", name(), offset);
    switch (record.op) {
      case Ros1Op::kBagHeader:
        is_encrypted_ = record.fields.Has("encryptor") && !record.fields.Text("encryptor").empty();
        return;
      case Ros1Op::kChunk: {
        const Chunk chunk{.data_offset = offset + record.data_at,
                          .data_bytes = record.data_bytes,
                          .compression = CompressionOf(record.fields.Text("compression"), where),
                          .inflated_bytes = record.fields.U32("size")};
        if (chunk.compression == Codec::kNone && chunk.inflated_bytes != chunk.data_bytes) {
          throw DataError("{}: a chunk of {} bytes that announces {}", where, chunk.data_bytes,
                          chunk.inflated_bytes);
        }
        chunks_.push_back(chunk);
        return;
      }
      case Ros1Op::kIndexData:
        TakeIndex(record, offset);
        return;
      case Ros1Op::kConnection:
        if (record.data_bytes > kMaxConnectionBytes) {
          throw DataError("{}: a connection of {} bytes, expected at most {}", where, record.data_bytes,
                          kMaxConnectionBytes);
        }
        TakeConnection(record, FileBytes(offset + record.data_at, record.data_bytes, "connection"),
                       offset + record.data_at);
        return;
      case Ros1Op::kMessage:    // messages are in chunks
      case Ros1Op::kChunkInfo:  // repeats the content of chunks and indices
        return;
    }
    throw DataError("{}: record of kind {}, expected 2..7", where, static_cast<int>(record.op));
  }

  void TakeIndex(const Record& record, std::uint64_t offset) {
    const std::string where = fmt::format("{}: byte {}: index", name(), offset);
    if (chunks_.empty()) throw DataError("{}: no chunk before it", where);
    if (record.fields.U32("ver") != 1) {
      throw DataError("{}: version {}, expected 1", where, record.fields.U32("ver"));
    }
    const std::uint32_t count = record.fields.U32("count");
    if (count * kIndexEntryBytes != record.data_bytes) {
      throw DataError("{}: {} entries in {} bytes, expected {} bytes each", where, count, record.data_bytes,
                      kIndexEntryBytes);
    }
    const std::uint64_t data_offset = offset + record.data_at;
    const std::vector<std::byte> bytes = FileBytes(data_offset, record.data_bytes, "index");
    const ByteReader entries(bytes, name(), data_offset);
    Chunk& chunk = chunks_.back();
    std::vector<BagMessage> messages;
    messages.reserve(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint64_t at = i * kIndexEntryBytes;
      const std::uint32_t position = entries.U32(at + 8, "offset of a message");
      if (position >= chunk.inflated_bytes) {
        throw DataError("{}: {}, expected less than the chunk's {} bytes",
                        entries.Where(at + 8, "offset of a message"), position, chunk.inflated_bytes);
      }
      messages.push_back({.log_time_ns = entries.U32(at, "time") * kNsPerS + entries.U32(at + 4, "time"),
                          .container = chunks_.size() - 1,
                          .position = position});
    }
    chunk.has_index = true;
    std::vector<BagMessage>& all = messages_[record.fields.U32("conn")];
    all.insert(all.end(), messages.begin(), messages.end());
  }

  void TakeConnection(const Record& record, std::span<const std::byte> data, std::uint64_t data_offset) {
    const Fields about({data, name(), data_offset});
    connections_[record.fields.U32("conn")] = {record.fields.Text("topic"), Ros1TypeName(about.Text("type"))};
  }

  // A truncated bag contains its connections only inside the chunks, before their first message.
  void FindMissingConnections() {
    std::set<std::uint64_t> chunks;
    for (const auto& [id, messages] : messages_) {
      if (!connections_.contains(id) && !messages.empty()) chunks.insert(messages.front().container);
    }
    for (const std::uint64_t index : chunks) {
      try {
        const auto bytes = Inflated(index);
        const ByteReader reader(*bytes, ChunkName(chunks_[index]));
        for (std::uint64_t at = 0; at < bytes->size();) {
          const Record record = ParseRecord(reader, at, bytes->size() - at);
          if (record.op == Ros1Op::kConnection)
            TakeConnection(record, reader.Bytes(record.data_at, record.data_bytes, "connection"), at);
          at = record.end();
        }
      } catch (const DataError& error) {
        notes_.push_back(fmt::format("A chunk is damaged: {}.", error.what()));
      }
    }
  }

  void ListTopics() {
    std::uint64_t nameless = 0;
    for (const auto& [id, messages] : messages_) {
      const auto connection = connections_.find(id);
      if (connection == connections_.end()) {
        nameless += messages.size();
        continue;
      }
      const Connection& about = connection->second;
      const auto known = std::ranges::find_if(topics_, [&](const BagTopic& other) {
        return other.name == about.topic && other.type == about.type;
      });
      if (known == topics_.end()) {
        topics_.push_back({about.topic, about.type, messages.size()});
      } else {
        known->count += messages.size();
      }
    }
    std::ranges::sort(topics_, {}, &BagTopic::name);
    if (nameless > 0)
      notes_.push_back(fmt::format("{} messages are of no known topic and were left out.", nameless));
  }

  std::string ChunkName(const Chunk& chunk) const {
    return fmt::format("{}: inside the chunk at byte {}", name(), chunk.data_offset);
  }

  // Inflated records of a chunk. The last chunk is cached, because messages are read in order.
  std::shared_ptr<const std::vector<std::byte>> Inflated(std::uint64_t index) const {
    const std::lock_guard lock(inflated_mutex_);
    if (inflated_ && inflated_index_ == index) return inflated_;
    const Chunk& chunk = chunks_.at(index);
    if (std::max<std::uint64_t>(chunk.inflated_bytes, chunk.data_bytes) > kMaxBagMessageBytes) {
      throw DataError("{}: {} bytes, expected at most {}", ChunkName(chunk), chunk.inflated_bytes,
                      kMaxBagMessageBytes);
    }
    inflated_ = std::make_shared<const std::vector<std::byte>>(
        InflatedBytes(chunk, FileBytes(chunk.data_offset, chunk.data_bytes, "chunk"), ChunkName(chunk)));
    inflated_index_ = index;
    return inflated_;
  }

  fs::path file_;
  std::uint64_t file_bytes_;
  bool is_encrypted_ = false;
  std::vector<Chunk> chunks_;
  std::map<std::uint32_t, Connection> connections_;
  std::map<std::uint32_t, std::vector<BagMessage>> messages_;  // by connection
  std::vector<BagTopic> topics_;
  std::vector<std::string> notes_;
  mutable std::mutex inflated_mutex_;
  mutable std::shared_ptr<const std::vector<std::byte>> inflated_;
  mutable std::uint64_t inflated_index_ = 0;
};

}  // namespace

std::unique_ptr<Bag> OpenRos1Bag(const fs::path& file) {
  return std::make_unique<Ros1Bag>(file);
}

}  // namespace sonarcal::data_io
