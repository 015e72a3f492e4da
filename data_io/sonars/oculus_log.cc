#include "data_io/sonars/oculus_log.h"

#include <zlib.h>

#include <algorithm>
#include <utility>

#include "core/types/error.h"
#include "data_io/files/byte_reader.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kLogMagic = 0x11223344;
constexpr std::uint32_t kItemMagic = 0xaabbccdd;
constexpr std::uint64_t kLogHeadBytes = 48;
constexpr std::uint64_t kItemHeadBytes = 40;
constexpr std::uint64_t kMaxHeadBytes = 4096;
constexpr std::uint64_t kLengthBytes = 4;  // length before a compressed payload
constexpr std::uint16_t kSonarItem = 10;

std::uint64_t HeadBytes(const ByteReader& reader, std::uint64_t known) {
  const std::uint64_t bytes = reader.U32(4, "size of the head");
  if (bytes < known || bytes > kMaxHeadBytes) {
    throw DataError("{}: {}, expected {}..{}", reader.Where(4, "size of the head"), bytes, known,
                    kMaxHeadBytes);
  }
  return bytes;
}

// First `wanted` bytes of a message, or all of it if it is shorter.
std::vector<std::byte> Inflate(std::vector<std::byte> packed, const OculusLogItem& item, std::uint64_t wanted,
                               const std::string& where) {
  const std::uint64_t announced =
      std::to_integer<std::uint64_t>(packed[0]) << 24 | std::to_integer<std::uint64_t>(packed[1]) << 16 |
      std::to_integer<std::uint64_t>(packed[2]) << 8 | std::to_integer<std::uint64_t>(packed[3]);
  if (announced != item.original_bytes) {
    throw DataError("{}: the compressed payload announces {} bytes, the item {}", where, announced,
                    item.original_bytes);
  }
  std::vector<std::byte> message(std::min(item.original_bytes, wanted));
  z_stream stream{};
  SONARCAL_CHECK(inflateInit(&stream) == Z_OK, "zlib has no memory");
  stream.next_in = reinterpret_cast<Bytef*>(packed.data() + kLengthBytes);
  stream.avail_in = static_cast<uInt>(packed.size() - kLengthBytes);
  stream.next_out = reinterpret_cast<Bytef*>(message.data());
  stream.avail_out = static_cast<uInt>(message.size());
  const int result = inflate(&stream, Z_SYNC_FLUSH);
  const std::uint64_t came_out = message.size() - stream.avail_out;
  inflateEnd(&stream);
  // zlib compares the checksum at the end of the stream.
  const bool wants_end = message.size() == item.original_bytes;
  const bool is_good = result == Z_STREAM_END || (result == Z_OK && !wants_end);
  if (!is_good || came_out != message.size()) {
    const char* const fault = stream.msg != nullptr    ? stream.msg
                              : result == Z_STREAM_END ? "the stream ends there"
                                                       : "the end of the stream was not reached";
    throw DataError("{}: the compressed payload is damaged: {} of {} bytes came out: {}", where, came_out,
                    message.size(), fault);
  }
  return message;
}

struct ItemHead {
  OculusLogItem item;
  std::uint16_t type = 0;
};

// `file_bytes` is the size of the file.
ItemHead ReadItemHead(const fs::path& file, std::uint64_t offset, std::uint64_t file_bytes) {
  const std::vector<std::byte> bytes = ReadFileRange(
      file, offset, std::min(file_bytes - std::min(offset, file_bytes), kItemHeadBytes), "item head");
  const ByteReader reader(bytes, file.string(), offset);
  if (reader.U32(0, "magic number") != kItemMagic) {
    throw DataError("{}: {:#010x}, expected {:#010x}", reader.Where(0, "magic number"),
                    reader.U32(0, "magic number"), kItemMagic);
  }
  const std::uint16_t compression = reader.U16(24, "compression");
  if (compression > 1) {
    throw DataError("{}: {}, expected 0 or 1", reader.Where(24, "compression"), compression);
  }
  const OculusLogItem item{.offset = offset,
                           .payload_offset = offset + HeadBytes(reader, kItemHeadBytes),
                           .payload_bytes = reader.U32(32, "payload size"),
                           .original_bytes = reader.U32(28, "original size"),
                           .compressed = compression == 1,
                           .time_s = reader.F64(16, "time")};
  if (item.payload_offset > file_bytes || item.payload_bytes > file_bytes - item.payload_offset) {
    throw DataError("{}: {}, of which the file holds {}", reader.Where(32, "payload size"),
                    item.payload_bytes, file_bytes - std::min(file_bytes, item.payload_offset));
  }
  return {item, reader.U16(8, "type")};
}

}  // namespace

bool IsOculusLog(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) < sizeof(kLogMagic) || error)
    return false;
  return LittleEndian(ReadFileRange(path, 0, sizeof(kLogMagic), "magic number")) == kLogMagic;
}

std::vector<std::string> ForEachOculusLogItem(const fs::path& file,
                                              const std::function<void(const OculusLogItem&)>& on_item) {
  const std::uint64_t size = RegularFileSize(file);
  const std::vector<std::byte> bytes = ReadFileRange(file, 0, std::min(size, kLogHeadBytes), "log head");
  const ByteReader head(bytes, file.string());
  if (head.U32(0, "magic number") != kLogMagic) {
    throw DataError("{}: {:#010x}, expected {:#010x}", head.Where(0, "magic number"),
                    head.U32(0, "magic number"), kLogMagic);
  }
  if (head.U16(26, "encryption") != 0) {
    throw DataError("{}: {}, expected 0: encrypted logs cannot be read", head.Where(26, "encryption"),
                    head.U16(26, "encryption"));
  }
  std::vector<std::string> notes;
  int others = 0;
  std::uint64_t offset = HeadBytes(head, kLogHeadBytes);
  while (offset < size) {
    ItemHead next;
    try {
      next = ReadItemHead(file, offset, size);
    } catch (const DataError& error) {
      notes.push_back(fmt::format("The {} bytes from byte {} on are not a whole item and were omitted: {}.",
                                  size - offset, offset, error.what()));
      break;
    }
    if (next.type == kSonarItem) {
      on_item(next.item);
    } else {
      ++others;
    }
    offset = next.item.payload_offset + next.item.payload_bytes;
  }
  if (others > 0) notes.push_back(fmt::format("{} items that are not the sonar's were skipped.", others));
  return notes;
}

OculusLogItem ReadOculusLogItemHead(const fs::path& file, std::uint64_t offset) {
  return ReadItemHead(file, offset, RegularFileSize(file)).item;
}

std::vector<std::byte> ReadOculusLogItem(const fs::path& file, const OculusLogItem& item,
                                         std::uint64_t wanted_bytes) {
  const std::string where = fmt::format("{}: item at byte {}", file.string(), item.offset);
  if (std::max(item.original_bytes, item.payload_bytes) > kMaxOculusMessageBytes) {
    throw DataError("{}: a message of {} bytes, expected at most {}", where,
                    std::max(item.original_bytes, item.payload_bytes), kMaxOculusMessageBytes);
  }
  const std::uint64_t read_bytes =
      item.compressed ? item.payload_bytes : std::min(item.payload_bytes, wanted_bytes);
  std::vector<std::byte> payload = ReadFileRange(file, item.payload_offset, read_bytes, "payload of an item");
  if (!item.compressed) return payload;
  if (payload.size() < kLengthBytes) {
    throw DataError("{}: a compressed payload of {} bytes, expected at least {}", where, payload.size(),
                    kLengthBytes);
  }
  return Inflate(std::move(payload), item, wanted_bytes, where);
}

}  // namespace sonarcal::data_io
