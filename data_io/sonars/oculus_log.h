// The log that the maker's viewer writes of a Blueprint Subsea Oculus (`.oculus`): a head, then items, each
// holding one message as the sonar sent it (data_io/sonars/oculus_io.h), compressed or not.
//
// Layout, little-endian, with the padding of the maker's structures:
//   head, 48 bytes   u32 0x11223344 at 0, u32 size of the head 4, char[16] source 8, u16 version 24, u16
//                    encryption 26 (0 = none), i64 key 32, f64 time 40
//   item, 40 bytes   u32 0xaabbccdd at 0, u32 size of the head 4, u16 type 8 (10 = sonar), u16 version 10,
//   f64
//                    time 16, u16 compression 24 (0 none, 1 zlib), u32 original size 28, u32 payload size 32
//   then the payload; compressed, it begins with its original size again, u32 big-endian.
// Both heads may be longer than their known fields: the size they give is where the rest begins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace sonarcal::data_io {

// No message is inflated beyond this; the largest image of an Oculus has a few megabytes.
inline constexpr std::uint64_t kMostOculusMessageBytes = 64 << 20;

struct OculusLogItem {
  std::uint64_t offset = 0;  // of the item's head in the file
  std::uint64_t payload_offset = 0;
  std::uint64_t payload_bytes = 0;
  std::uint64_t original_bytes = 0;
  bool compressed = false;
  double time_s = 0.0;  // as recorded: seconds, of an epoch that is not documented
};

// True where the file begins with the head of such a log.
bool IsOculusLog(const std::filesystem::path& path);

// Walks through the heads of all items and hands over those of the sonar, one by one: a log may be of any
// length. Returns what was passed over, one sentence each. Throws DataError where the log is encrypted or its
// head damaged; what follows a damaged item is left out, with a note.
std::vector<std::string> ForEachOculusLogItem(const std::filesystem::path& file,
                                              const std::function<void(const OculusLogItem&)>& on_item);

// The item whose head lies at `offset`. Throws DataError where it is damaged, or cut short.
OculusLogItem ReadOculusLogItemHead(const std::filesystem::path& file, std::uint64_t offset);

// The first bytes of an item's message, inflated; all of it where it is shorter. Throws DataError where it is
// damaged, or longer than kMostOculusMessageBytes.
std::vector<std::byte> ReadOculusLogItem(const std::filesystem::path& file, const OculusLogItem& item,
                                         std::uint64_t wanted_bytes = kMostOculusMessageBytes);

}  // namespace sonarcal::data_io
