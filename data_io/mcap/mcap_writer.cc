#include "data_io/mcap/mcap_writer.h"

#include <algorithm>
#include <cerrno>
#include <limits>
#include <span>
#include <utility>

#include "core/types/error.h"
#include "data_io/files/byte_reader.h"
#include "data_io/files/compression.h"
#include "data_io/files/file_bytes.h"
#include "data_io/mcap/mcap_records.h"

namespace sonarcal::data_io {
namespace {

constexpr std::size_t kMcapChunkBytes = 4 << 20;  // a chunk is closed when it has as many
constexpr const char* kCompression = "zstd";

// Fields of a record in sequence.
class Content {
 public:
  Content& U8(std::uint64_t value) { return Integer(value, 1); }
  Content& U16(std::uint64_t value) { return Integer(value, 2); }
  Content& U32(std::uint64_t value) { return Integer(value, 4); }
  Content& U64(std::uint64_t value) { return Integer(value, 8); }
  Content& Raw(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  // A string, an array or a map: its length in bytes, and the bytes.
  Content& Text(std::string_view bytes) {
    if (bytes.size() > std::numeric_limits<std::uint32_t>::max())
      throw DataError("{} bytes, expected at most 2^32 - 1 for a string of MCAP", bytes.size());
    return U32(bytes.size()).Raw(bytes);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  Content& Integer(std::uint64_t value, int size) {
    bytes_ += LittleEndianBytes(value, size);
    return *this;
  }

  std::string bytes_;
};

std::string Record(McapKind kind, const Content& content) {
  Content record;
  record.U8(static_cast<std::uint8_t>(kind)).U64(content.bytes().size()).Raw(content.bytes());
  return record.bytes();
}

}  // namespace

void McapWriter::Times::Add(std::uint64_t time_ns) {
  first_ns = count == 0 ? time_ns : std::min(first_ns, time_ns);
  last_ns = std::max(last_ns, time_ns);
  ++count;
}

McapWriter::McapWriter(const std::filesystem::path& file, std::string_view profile, std::string_view library)
    : name_(file.string()), stream_(file, std::ios::binary) {
  Put(kMcapMagic);
  Put(Record(McapKind::kHeader, Content().Text(profile).Text(library)));
}

std::uint16_t McapWriter::AddChannel(const McapChannelDefinition& channel) {
  const auto id = static_cast<std::uint16_t>(message_counts_.size() + 1);
  const auto [schema, is_new] = schema_ids_.emplace(channel.schema_name, schema_ids_.size() + 1);
  if (is_new) {
    const std::string record = Record(McapKind::kSchema, Content()
                                                             .U16(schema->second)
                                                             .Text(channel.schema_name)
                                                             .Text(channel.schema_encoding)
                                                             .Text(channel.schema));
    schema_records_ += record;
    chunk_ += record;
  }
  const std::string record = Record(
      McapKind::kChannel,
      Content().U16(id).U16(schema->second).Text(channel.topic).Text(channel.message_encoding).Text(""));
  channel_records_ += record;
  chunk_ += record;
  message_counts_[id] = 0;
  return id;
}

void McapWriter::Write(std::uint16_t channel, std::int64_t time_ns, std::string_view data) {
  const auto time = static_cast<std::uint64_t>(time_ns);
  std::uint64_t& count = message_counts_.at(channel);
  chunk_index_[channel] += Content().U64(time).U64(chunk_.size()).bytes();
  chunk_ += Record(McapKind::kMessage, Content().U16(channel).U32(count).U64(time).U64(time).Raw(data));
  ++count;
  chunk_times_.Add(time);
  times_.Add(time);
  if (chunk_.size() >= kMcapChunkBytes) FlushChunk();
}

void McapWriter::AddMetadata(std::string_view name, const std::map<std::string, std::string>& values) {
  FlushChunk();
  Content pairs;
  for (const auto& [key, value] : values) pairs.Text(key).Text(value);
  const std::string record = Record(McapKind::kMetadata, Content().Text(name).Text(pairs.bytes()));
  metadata_indices_ += Record(McapKind::kMetadataIndex, Content().U64(offset_).U64(record.size()).Text(name));
  Put(record);
  ++metadata_;
}

void McapWriter::Close() {
  FlushChunk();
  Put(Record(McapKind::kDataEnd, Content().U32(crc_)));
  const std::uint64_t summary_at = offset_;
  crc_ = 0;
  std::string offsets;
  for (const auto& [kind, records] : {std::pair<McapKind, std::string>{McapKind::kSchema, schema_records_},
                                      {McapKind::kChannel, channel_records_},
                                      {McapKind::kStatistics, Statistics()},
                                      {McapKind::kChunkIndex, chunk_indices_},
                                      {McapKind::kMetadataIndex, metadata_indices_}}) {
    if (records.empty()) continue;
    offsets += Record(McapKind::kSummaryOffset,
                      Content().U8(static_cast<std::uint8_t>(kind)).U64(offset_).U64(records.size()));
    Put(records);
  }
  const std::uint64_t offsets_at = offset_;
  Put(offsets);
  // The CRC of the summary includes the footer up to the CRC itself.
  std::string footer = Record(McapKind::kFooter, Content().U64(summary_at).U64(offsets_at).U32(0));
  footer.resize(footer.size() - 4);
  Put(footer);
  Put(Content().U32(crc_).bytes());
  Put(kMcapMagic);
  stream_.close();
  if (!stream_) FailToWrite(name_);
}

void McapWriter::Put(std::string_view bytes) {
  errno = 0;
  stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream_) FailToWrite(name_);
  offset_ += bytes.size();
  crc_ = McapCrc(bytes, crc_);
}

void McapWriter::FlushChunk() {
  if (chunk_.empty()) return;
  const std::vector<std::byte> packed = Compress(Codec::kZstd, std::as_bytes(std::span(chunk_)));
  const std::string times = Content().U64(chunk_times_.first_ns).U64(chunk_times_.last_ns).bytes();
  const std::string chunk =
      Record(McapKind::kChunk, Content()
                                   .Raw(times)
                                   .U64(chunk_.size())
                                   .U32(McapCrc(chunk_))
                                   .Text(kCompression)
                                   .U64(packed.size())
                                   .Raw({reinterpret_cast<const char*>(packed.data()), packed.size()}));
  const std::uint64_t chunk_at = offset_;
  Put(chunk);
  const std::uint64_t indices_at = offset_;
  Content index_offsets;
  for (const auto& [channel, entries] : chunk_index_) {
    index_offsets.U16(channel).U64(offset_);
    Put(Record(McapKind::kMessageIndex, Content().U16(channel).Text(entries)));
  }
  chunk_indices_ += Record(McapKind::kChunkIndex, Content()
                                                      .Raw(times)
                                                      .U64(chunk_at)
                                                      .U64(chunk.size())
                                                      .Text(index_offsets.bytes())
                                                      .U64(offset_ - indices_at)
                                                      .Text(kCompression)
                                                      .U64(packed.size())
                                                      .U64(chunk_.size()));
  ++chunks_;
  chunk_.clear();
  chunk_index_.clear();
  chunk_times_ = {};
}

std::string McapWriter::Statistics() const {
  Content counts;
  for (const auto& [channel, count] : message_counts_) counts.U16(channel).U64(count);
  return Record(McapKind::kStatistics, Content()
                                           .U64(times_.count)
                                           .U16(schema_ids_.size())
                                           .U32(message_counts_.size())
                                           .U32(0)  // attachments
                                           .U32(metadata_)
                                           .U32(chunks_)
                                           .U64(times_.first_ns)
                                           .U64(times_.last_ns)
                                           .Text(counts.bytes()));
}

}  // namespace sonarcal::data_io
