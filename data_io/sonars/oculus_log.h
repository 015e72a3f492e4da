// Log of the manufacturer's viewer for a Blueprint Subsea Oculus (`.oculus`): a head, then items. Each item
// holds one message of the sonar (data_io/sonars/oculus_io.h), compressed or not.
//
// Layout, little-endian, with the padding of the manufacturer's structures:
//
//   head, 48 bytes   u32 0x11223344 at 0, u32 size of the head 4, char[16] source 8, u16 version 24, u16
//                    encryption 26 (0 = none), i64 key 32, f64 time 40
//   item, 40 bytes   u32 0xaabbccdd at 0, u32 size of the head 4, u16 type 8 (10 = sonar), u16 version 10,
//                    f64 time 16, u16 compression 24 (0 none, 1 zlib), u32 original size 28, u32 payload
//                    size 32
//   then the payload; a compressed one begins with its original size, u32 big-endian.
//
// Both heads may be longer than their known fields: the size in the head is the position of the following
// data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace sonarcal::data_io {

// Max size of an inflated message; the largest image of an Oculus has a few megabytes.
inline constexpr std::uint64_t kMaxOculusMessageBytes = 64 << 20;

struct OculusLogItem {
  std::uint64_t offset = 0;  // position of the item's head in the file
  std::uint64_t payload_offset = 0;
  std::uint64_t payload_bytes = 0;
  std::uint64_t original_bytes = 0;
  bool compressed = false;
  double time_s = 0.0;  // as recorded: seconds since an undocumented epoch
};

// True if the file begins with the head of such a log.
bool IsOculusLog(const std::filesystem::path& path);

// Reads the heads of all items and passes those of the sonar to `on_item`, one by one; a log may have any
// length. Returns notes about skipped items, one sentence each. Throws DataError if the log is encrypted or
// its head damaged. Items after a damaged one are omitted with a note.
std::vector<std::string> ForEachOculusLogItem(const std::filesystem::path& file,
                                              const std::function<void(const OculusLogItem&)>& on_item);

// Item whose head lies at `offset`. Throws DataError if it is damaged or truncated.
OculusLogItem ReadOculusLogItemHead(const std::filesystem::path& file, std::uint64_t offset);

// First `wanted_bytes` of an item's message, inflated, or all of it if it is shorter. Throws DataError if it
// is damaged, or longer than kMaxOculusMessageBytes.
std::vector<std::byte> ReadOculusLogItem(const std::filesystem::path& file, const OculusLogItem& item,
                                         std::uint64_t wanted_bytes = kMaxOculusMessageBytes);

}  // namespace sonarcal::data_io
