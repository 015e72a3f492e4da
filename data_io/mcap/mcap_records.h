// Records of the container MCAP, version 0: "\x89MCAP0\r\n", then records, then the same magic number. Each
// record has a kind (u8), the length of its content (u64) and the content. All numbers are little-endian. A
// string is a u32 length and its bytes. Source: mcap.dev/spec.
//
//   kind  record         content
//   1     header         string profile, string library
//   2     footer         u64 summary start, u64 summary offset start, u32 CRC of the summary
//   3     schema         u16 id, string name, string encoding, u32 length and data
//   4     channel        u16 id, u16 schema, string topic, string message encoding, map metadata
//   5     message        u16 channel, u32 sequence, u64 log time (ns), u64 publish time (ns), data
//   6     chunk          u64 start, u64 end, u64 inflated size, u32 CRC of the inflated records, string
//                        compression ("", "lz4", "zstd"), u64 length and records of kind 3, 4 and 5
//   7     message index  of the chunk before: u16 channel, u32 length and (u64 log time, u64 position) each
//   8     chunk index    u64 start, u64 end, u64 position and u64 length of the chunk, map of message
//                        indices, u64 their length, string compression, u64 packed size, u64 inflated size
//   11    statistics     u64 messages, u16 schemas, u32 channels, u32 attachments, u32 metadata, u32 chunks,
//                        u64 start, u64 end, map of messages by channel
//   12    metadata       string name, map of string to string
//   13    metadata index u64 position, u64 length and string name of a metadata record
//   14    summary offset u8 kind, u64 position and u64 length of the summary's records of this kind
//   15    end of data    u32 CRC of all bytes before it
//
// Readers skip other kinds and unknown fields at the end of a record. A CRC of 0 means that there is none.
#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "data_io/files/byte_reader.h"

namespace sonarcal::data_io {

inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};
inline constexpr std::uint64_t kMcapRecordHeadBytes = 9;    // kind and length
inline constexpr std::uint64_t kMcapMessageHeadBytes = 22;  // fields of a message before its data

enum class McapKind : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kMetadata = 12,
  kMetadataIndex = 13,
  kSummaryOffset = 14,
  kDataEnd = 15,
};

// CRC of bytes that follow those with the CRC `crc`.
inline std::uint32_t McapCrc(std::string_view bytes, std::uint32_t crc = 0) {
  return static_cast<std::uint32_t>(crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}
inline std::uint32_t McapCrc(std::span<const std::byte> bytes, std::uint32_t crc = 0) {
  return McapCrc(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()), crc);
}

// Fields of a record in sequence. Throws DataError, naming byte and field, for one that does not fit.
class McapFields {
 public:
  // The bytes of `reader` must outlive the fields.
  explicit McapFields(ByteReader reader) : reader_(std::move(reader)) {}

  std::uint8_t U8(std::string_view field) { return reader_.U8(Advance(1), field); }
  std::uint16_t U16(std::string_view field) { return reader_.U16(Advance(2), field); }
  std::uint32_t U32(std::string_view field) { return reader_.U32(Advance(4), field); }
  std::uint64_t U64(std::string_view field) { return reader_.U64(Advance(8), field); }
  std::span<const std::byte> Bytes(std::uint64_t count, std::string_view field) {
    return reader_.Bytes(Advance(count), count, field);
  }
  std::string String(std::string_view field) {
    const std::span<const std::byte> bytes = Bytes(U32(field), field);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  std::uint64_t position() const { return at_; }
  std::string Where(std::string_view field) const { return reader_.Where(at_, field); }

 private:
  std::uint64_t Advance(std::uint64_t count) {
    const std::uint64_t at = at_;
    at_ += count;
    return at;
  }

  ByteReader reader_;
  std::uint64_t at_ = 0;
};

}  // namespace sonarcal::data_io
