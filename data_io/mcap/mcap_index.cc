#include "data_io/mcap/mcap_index.h"

#include <algorithm>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/mcap/mcap_records.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxDefinitionBytes = 16 << 20;  // schemas and channels
constexpr std::uint64_t kMcapIndexEntryBytes = 16;
constexpr std::size_t kMaxNotes = 20;

// CRC of the bytes of a file from `begin` to `end`.
std::uint32_t FileCrc(const fs::path& file, std::uint64_t begin, std::uint64_t end) {
  constexpr std::uint64_t kPieceBytes = 1 << 20;
  std::uint32_t crc = 0;
  for (std::uint64_t at = begin; at < end; at += kPieceBytes)
    crc = McapCrc(ReadFileRange(file, at, std::min(kPieceBytes, end - at), "content"), crc);
  return crc;
}

// Heads of records, read through a buffer, because a file may have millions of short records.
class HeadReader {
 public:
  HeadReader(const fs::path& file, const std::string& name, std::uint64_t file_bytes)
      : file_(file), name_(name), file_bytes_(file_bytes) {}

  // `count` bytes from `offset`, or as many as the file has. Valid until the next call.
  ByteReader At(std::uint64_t offset, std::uint64_t count) {
    count = std::min(count, file_bytes_ - std::min(offset, file_bytes_));
    if (offset < begin_ || offset + count > begin_ + bytes_.size()) {
      bytes_ = ReadFileRange(file_, offset, std::min(std::max(count, kBufferBytes), file_bytes_ - offset),
                             "record");
      begin_ = offset;
    }
    return {std::span(bytes_).subspan(offset - begin_, count), name_, offset};
  }

 private:
  static constexpr std::uint64_t kBufferBytes = 32 << 10;

  const fs::path& file_;
  const std::string& name_;
  std::uint64_t file_bytes_;
  std::uint64_t begin_ = 0;
  std::vector<std::byte> bytes_;
};

struct RecordHead {
  McapKind kind = McapKind::kHeader;
  std::uint64_t content_at = 0;     // position in its container
  std::uint64_t content_bytes = 0;  // as announced
  std::uint64_t bytes_there = 0;    // of the content

  bool is_cut() const { return bytes_there < content_bytes; }
};

// Head at the start of `reader`, which is at `offset` of a container of `container_bytes`.
RecordHead ParseHead(const ByteReader& reader, std::uint64_t offset, std::uint64_t container_bytes) {
  RecordHead head{.kind = static_cast<McapKind>(reader.U8(0, "kind of a record")),
                  .content_at = offset + kMcapRecordHeadBytes,
                  .content_bytes = reader.U64(1, "length of a record")};
  head.bytes_there = std::min(head.content_bytes, container_bytes - head.content_at);
  if (static_cast<std::uint8_t>(head.kind) == 0) {
    throw DataError("{}: 0, expected at least 1", reader.Where(0, "kind of a record"));
  }
  return head;
}

class Scan {
 public:
  Scan(const fs::path& file, const std::string& name, std::uint64_t max_chunk_bytes)
      : file_(file),
        name_(name),
        max_chunk_bytes_(max_chunk_bytes),
        file_bytes_(RegularFileSize(file)),
        heads_(file, name, file_bytes_) {}

  McapIndex Run() {
    CheckMagic();
    WalkFile();
    ListMessagesOfChunks();
    FindMissingChannels();
    NameSchemas();
    CheckSums();
    return std::move(index_);
  }

 private:
  struct DataEnd {
    std::uint64_t offset;
    std::uint32_t crc;
  };

  void Note(const std::string& note) {
    if (index_.notes.size() < kMaxNotes) index_.notes.push_back(note);
  }

  void CheckMagic() {
    const std::vector<std::byte> bytes =
        ReadFileRange(file_, 0, std::min<std::uint64_t>(file_bytes_, kMcapMagic.size()), "magic number");
    const std::string_view found(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (found == kMcapMagic) return;
    throw DataError("{}: byte 0: '{}', expected the magic number of MCAP, version 0", name_,
                    Printable(found));
  }

  // Takes all records of the file itself.
  void WalkFile() {
    std::uint64_t offset = kMcapMagic.size();
    while (!footer_ && offset + kMcapRecordHeadBytes <= file_bytes_) {
      RecordHead head;
      try {
        head = ParseHead(heads_.At(offset, kMcapRecordHeadBytes), offset, file_bytes_);
      } catch (const DataError& error) {
        Note(fmt::format("The {} bytes from byte {} on are no records and were left out: {}.",
                         file_bytes_ - offset, offset, error.what()));
        return;
      }
      try {
        Take(head, offset);
      } catch (const DataError& error) {
        Note(fmt::format("The record at byte {} was left out: {}.", offset, error.what()));
      }
      if (head.is_cut()) break;
      offset = head.content_at + head.content_bytes;
    }
    const bool ends_well = footer_ && file_bytes_ - offset >= kMcapMagic.size();
    if (!ends_well) {
      Note(fmt::format(
          "The file ends at byte {} without a footer: it was cut off, and is read as far as it goes.",
          file_bytes_));
    }
  }

  void Take(const RecordHead& head, std::uint64_t offset) {
    switch (head.kind) {
      case McapKind::kSchema:
      case McapKind::kChannel:
        return TakeDefinition(head);
      case McapKind::kMetadata:
        return TakeMetadata(head);
      case McapKind::kMessage:
        return AddMessage(heads_.At(head.content_at, kMcapMessageHeadBytes), 0, offset);
      case McapKind::kChunk:
        return TakeChunk(head);
      case McapKind::kMessageIndex:
        return TakeMessageIndex(head);
      case McapKind::kStatistics:
        announced_messages_ = heads_.At(head.content_at, 8).U64(0, "number of messages");
        return;
      case McapKind::kDataEnd:
        data_end_ = {offset, heads_.At(head.content_at, 4).U32(0, "CRC of the data")};
        return;
      case McapKind::kFooter:
        return TakeFooter(head);
      default:
        return;
    }
  }

  // Content of a record that is held in memory.
  std::vector<std::byte> ReadContent(const RecordHead& head, const char* what) {
    if (head.is_cut() || head.content_bytes > kMaxDefinitionBytes) {
      throw DataError("{}: byte {}: {} of {} bytes, of which {} are there, expected at most {}", name_,
                      head.content_at, what, head.content_bytes, head.bytes_there, kMaxDefinitionBytes);
    }
    return ReadFileRange(file_, head.content_at, head.content_bytes, what);
  }

  void TakeDefinition(const RecordHead& head) {
    const std::vector<std::byte> bytes = ReadContent(head, "definition");
    Define(head.kind, {bytes, name_, head.content_at});
  }

  void TakeMetadata(const RecordHead& head) {
    const std::vector<std::byte> bytes = ReadContent(head, "metadata");
    McapFields fields({bytes, name_, head.content_at});
    std::map<std::string, std::string>& pairs = index_.metadata[fields.String("name of metadata")];
    const std::uint64_t pair_bytes = fields.U32("length of metadata");
    const std::uint64_t begin = fields.position();
    while (fields.position() - begin < pair_bytes) {
      std::string key = fields.String("key of metadata");
      pairs[std::move(key)] = fields.String("value of metadata");
    }
  }

  // Records with one id are identical, so the first is kept.
  void Define(McapKind kind, const ByteReader& content) {
    McapFields fields(content);
    const std::uint16_t id = fields.U16("id");
    if (kind == McapKind::kSchema) {
      if (id != 0) schema_names_.emplace(id, fields.String("name of a schema"));
      return;
    }
    const std::uint16_t schema = fields.U16("schema of a channel");
    McapChannel channel;
    channel.topic = fields.String("topic of a channel");
    channel.message_encoding = fields.String("message encoding of a channel");
    if (index_.channels.emplace(id, channel).second) schema_of_channel_.emplace(id, schema);
    missing_channels_.erase(id);
  }

  // `head` holds the first fields of the message.
  void AddMessage(const ByteReader& head, std::uint64_t container, std::uint64_t position) {
    const std::uint16_t channel = head.U16(0, "channel of a message");
    AddMessage(channel, {.log_time_ns = static_cast<std::int64_t>(head.U64(6, "log time of a message")),
                         .container = container,
                         .position = position});
    if (container == 0) has_bare_messages_ = true;
  }

  void AddMessage(std::uint16_t channel, const McapMessage& message) {
    if (message_count_ == file_bytes_) {
      throw DataError("{}: more than {} messages in as many bytes, expected fewer: the file is damaged",
                      name_, file_bytes_);
    }
    index_.messages[channel].push_back(message);
    ++message_count_;
  }

  void TakeChunk(const RecordHead& head) {
    constexpr std::uint64_t kFixedBytes = 40;
    constexpr std::uint64_t kMaxNameBytes = 16;  // longest name of a compression
    follows_chunk_ = false;
    const ByteReader reader =
        heads_.At(head.content_at, std::min(head.bytes_there, kFixedBytes + kMaxNameBytes));
    McapFields fields(reader);
    fields.U64("start of a chunk");
    fields.U64("end of a chunk");
    McapChunk chunk;
    chunk.inflated_bytes = fields.U64("inflated size of a chunk");
    chunk.crc = fields.U32("CRC of a chunk");
    chunk.codec = CodecOf(fields.String("compression of a chunk"), fields.Where("chunk"));
    const std::uint64_t packed_bytes = fields.U64("length of a chunk");
    chunk.offset = head.content_at + fields.position();
    const std::uint64_t announced = head.content_bytes - fields.position();
    if (packed_bytes > announced) {
      throw DataError("{}: {}, of which the record holds {}", fields.Where("length of a chunk"), packed_bytes,
                      announced);
    }
    chunk.packed_bytes = std::min(packed_bytes, head.bytes_there - fields.position());
    chunk.is_cut = chunk.packed_bytes < packed_bytes;
    index_.chunks.push_back(chunk);
    follows_chunk_ = true;
  }

  static Codec CodecOf(const std::string& compression, const std::string& where) {
    if (compression.empty()) return Codec::kNone;
    if (compression == "lz4") return Codec::kLz4;
    if (compression == "zstd") return Codec::kZstd;
    throw DataError("{}: compression '{}', expected '', lz4 or zstd", where, Printable(compression));
  }

  void TakeMessageIndex(const RecordHead& head) {
    // The index of a chunk that was left out, or that has another index that is damaged, is of no use.
    if (head.is_cut() || !follows_chunk_) return;
    McapChunk& chunk = index_.chunks.back();
    // A damaged index leaves the chunk without one, so that its messages are listed from its content.
    chunk.has_index = false;
    follows_chunk_ = false;
    const ByteReader start = heads_.At(head.content_at, 6);
    const std::uint16_t channel = start.U16(0, "channel of a message index");
    const std::uint64_t bytes = start.U32(2, "length of a message index");
    if (bytes + 6 > head.content_bytes || bytes % kMcapIndexEntryBytes != 0) {
      throw DataError("{}: {}, expected a multiple of {} and at most {}",
                      start.Where(2, "length of a message index"), bytes, kMcapIndexEntryBytes,
                      head.content_bytes - std::min<std::uint64_t>(6, head.content_bytes));
    }
    const std::vector<std::byte> entries = ReadFileRange(file_, head.content_at + 6, bytes, "message index");
    const ByteReader reader(entries, name_, head.content_at + 6);
    for (std::uint64_t at = 0; at < bytes; at += kMcapIndexEntryBytes) {
      const std::uint64_t position = reader.U64(at + 8, "position of a message");
      if (position >= chunk.inflated_bytes) {
        throw DataError("{}: {}, expected less than the chunk's {} bytes",
                        reader.Where(at + 8, "position of a message"), position, chunk.inflated_bytes);
      }
      AddMessage(channel, {.log_time_ns = static_cast<std::int64_t>(reader.U64(at, "log time")),
                           .container = index_.chunks.size(),
                           .position = position});
    }
    chunk.has_index = true;
    follows_chunk_ = true;
  }

  void TakeFooter(const RecordHead& head) {
    const ByteReader reader = heads_.At(head.content_at, 20);
    footer_ = true;
    const std::uint64_t summary_at = reader.U64(0, "start of the summary");
    const std::uint32_t crc = reader.U32(16, "CRC of the summary");
    if (crc == 0 || summary_at == 0) return;
    const std::uint64_t end = head.content_at + 16;
    if (summary_at > end) {
      throw DataError("{}: {}, expected less than {}", reader.Where(0, "start of the summary"), summary_at,
                      end);
    }
    CheckSum("summary", crc, summary_at, end);
  }

  void CheckSum(const char* what, std::uint32_t expected, std::uint64_t begin, std::uint64_t end) {
    const std::uint32_t found = FileCrc(file_, begin, end);
    if (found == expected) return;
    Note(fmt::format("The CRC of the {} is {:08x}, expected {:08x}: bytes {} to {} of {} are damaged.", what,
                     found, expected, begin, end, name_));
  }

  // A message outside chunks has no CRC of its own. The CRC of all data requires all bytes to be read.
  void CheckSums() {
    if (data_end_ && data_end_->crc != 0 && has_bare_messages_)
      CheckSum("data", data_end_->crc, 0, data_end_->offset);
    if (announced_messages_ && *announced_messages_ != message_count_) {
      Note(fmt::format("The file's statistics count {} messages, but {} were found.", *announced_messages_,
                       message_count_));
    }
  }

  // Calls `take` with the head and the reader of every record in a chunk's content, and with true if only a
  // part of the record is there. Returns why the rest of the content is no record; empty if all is well.
  template <typename Take>
  std::string ForEachRecordIn(const McapContent& content, const std::string& where, Take take) {
    const std::uint64_t size = content.bytes.size();
    for (std::uint64_t at = 0; at < size;) {
      if (size - at < kMcapRecordHeadBytes) return fmt::format("{}: byte {}: {} bytes", where, at, size - at);
      try {
        const std::span<const std::byte> rest = std::span(content.bytes).subspan(at);
        const RecordHead head = ParseHead({rest.first(kMcapRecordHeadBytes), where, at}, at, size);
        take(head, ByteReader(rest.subspan(kMcapRecordHeadBytes, head.bytes_there), where,
                              at + kMcapRecordHeadBytes));
        if (head.is_cut()) return fmt::format("{}: byte {}: an incomplete record", where, at);
        at = head.content_at + head.content_bytes;
      } catch (const DataError& error) {
        return error.what();
      }
    }
    return {};
  }

  // Returns false and adds a note if the chunks inflate to more than a plausible recording.
  bool MayInflate(const McapChunk& chunk) {
    inflated_ += std::min(chunk.inflated_bytes, max_chunk_bytes_);
    if (inflated_ <= std::max(kMinInflationLimit, file_bytes_ * kMaxInflationRatio)) return true;
    Note(
        fmt::format("{}: the chunks inflate to more than {} times the size of the file: this chunk was left "
                    "out.",
                    McapChunkName(name_, chunk), kMaxInflationRatio));
    return false;
  }

  // Lists the messages of the chunks without a complete index from their content.
  void ListMessagesOfChunks() {
    std::set<std::uint64_t> containers;
    for (std::size_t i = 0; i < index_.chunks.size(); ++i) {
      // The indices behind the last chunk may be incomplete if the file was cut off.
      const bool may_lack_indices = !data_end_ && i + 1 == index_.chunks.size();
      if ((!index_.chunks[i].has_index || may_lack_indices) && MayInflate(index_.chunks[i]))
        containers.insert(i + 1);
    }
    for (auto& [channel, messages] : index_.messages) {
      message_count_ -= std::erase_if(
          messages, [&](const McapMessage& message) { return containers.contains(message.container); });
    }
    for (const std::uint64_t container : containers) ListMessagesOf(container - 1);
  }

  void ListMessagesOf(std::size_t index) {
    const McapChunk& chunk = index_.chunks[index];
    const McapContent content = ReadMcapChunk(file_, name_, chunk, max_chunk_bytes_);
    std::string fault = content.fault;
    const std::string rest = ForEachRecordIn(
        content, McapChunkName(name_, chunk), [&](const RecordHead& head, const ByteReader& reader) {
          if (head.kind == McapKind::kMessage) {
            // A message of which not even the first fields are there cannot be listed.
            if (reader.size() < kMcapMessageHeadBytes && head.is_cut()) return;
            AddMessage(reader, index + 1, head.content_at - kMcapRecordHeadBytes);
          } else if ((head.kind == McapKind::kSchema || head.kind == McapKind::kChannel) && !head.is_cut()) {
            Define(head.kind, reader);
          }
        });
    if (fault.empty() && !chunk.is_cut) fault = rest;
    if (!fault.empty()) Note(fmt::format("A chunk without an index is damaged: {}.", fault));
  }

  // The definition of a channel stands in the summary, or in the chunk of its first message or before it.
  void FindMissingChannels() {
    for (const auto& [channel, messages] : index_.messages) {
      if (!messages.empty() && !index_.channels.contains(channel)) missing_channels_.insert(channel);
    }
    for (const McapChunk& chunk : index_.chunks) {
      if (missing_channels_.empty()) return;
      if (!chunk.has_index) continue;
      if (!MayInflate(chunk)) break;
      const McapContent content = ReadMcapChunk(file_, name_, chunk, max_chunk_bytes_);
      if (!content.fault.empty()) continue;
      ForEachRecordIn(content, McapChunkName(name_, chunk),
                      [&](const RecordHead& head, const ByteReader& reader) {
                        if (head.kind == McapKind::kSchema || head.kind == McapKind::kChannel)
                          Define(head.kind, reader);
                      });
    }
    std::uint64_t nameless = 0;
    std::erase_if(index_.messages, [&](const auto& entry) {
      if (index_.channels.contains(entry.first)) return false;
      nameless += entry.second.size();
      return true;
    });
    if (nameless > 0)
      Note(fmt::format("{}: {} messages are of no known channel and were left out.", name_, nameless));
  }

  void NameSchemas() {
    for (auto& [id, channel] : index_.channels) {
      const auto name = schema_names_.find(schema_of_channel_.at(id));
      if (name != schema_names_.end()) channel.schema_name = name->second;
    }
  }

  const fs::path& file_;
  const std::string& name_;
  std::uint64_t max_chunk_bytes_;
  std::uint64_t file_bytes_;
  HeadReader heads_;
  McapIndex index_;
  std::map<std::uint16_t, std::string> schema_names_;
  std::map<std::uint16_t, std::uint16_t> schema_of_channel_;
  std::set<std::uint16_t> missing_channels_;  // have messages, no definition yet
  std::uint64_t message_count_ = 0;
  std::uint64_t inflated_ = 0;  // bytes of the chunks that were looked into
  bool follows_chunk_ = false;
  bool has_bare_messages_ = false;
  bool footer_ = false;
  std::optional<DataEnd> data_end_;
  std::optional<std::uint64_t> announced_messages_;
};

}  // namespace

McapIndex ReadMcapIndex(const fs::path& file, const std::string& name, std::uint64_t max_chunk_bytes) {
  return Scan(file, name, max_chunk_bytes).Run();
}

std::string McapChunkName(const std::string& name, const McapChunk& chunk) {
  return fmt::format("{}: inside the chunk at byte {}", name, chunk.offset);
}

McapContent ReadMcapChunk(const fs::path& file, const std::string& name, const McapChunk& chunk,
                          std::uint64_t max_chunk_bytes) {
  const std::string where = McapChunkName(name, chunk);
  if (std::max(chunk.inflated_bytes, chunk.packed_bytes) > max_chunk_bytes) {
    return {.bytes = {},
            .fault = fmt::format("{}: {} bytes, expected at most {}", where,
                                 std::max(chunk.inflated_bytes, chunk.packed_bytes), max_chunk_bytes)};
  }
  const std::vector<std::byte> packed = ReadFileRange(file, chunk.offset, chunk.packed_bytes, "chunk");
  Inflated inflated = Inflate(chunk.codec, packed, chunk.inflated_bytes);
  McapContent content{.bytes = std::move(inflated.bytes), .fault = {}};
  switch (inflated.end) {
    case Inflated::End::kDamaged:
      content.fault = fmt::format("{}: the compressed bytes are damaged: {}", where, inflated.fault);
      return content;
    case Inflated::End::kMore:
      content.fault = fmt::format("{}: more bytes come out than the {} that the chunk announces", where,
                                  chunk.inflated_bytes);
      return content;
    case Inflated::End::kCut:
    case Inflated::End::kWhole:
      break;
  }
  if (chunk.is_cut) return content;
  if (content.bytes.size() != chunk.inflated_bytes) {
    content.fault = fmt::format("{}: {} bytes come out, expected the {} that the chunk announces", where,
                                content.bytes.size(), chunk.inflated_bytes);
    return content;
  }
  const std::uint32_t crc = McapCrc(content.bytes);
  if (chunk.crc != 0 && crc != chunk.crc)
    content.fault =
        fmt::format("{}: the CRC is {:08x}, expected {:08x}: the chunk is damaged", where, crc, chunk.crc);
  return content;
}

}  // namespace sonarcal::data_io
