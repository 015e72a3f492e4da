// One record of a ROS 1 bag: its header fields and the position of its data. Layout: data_io/ros/ros1_bag.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "data_io/files/byte_reader.h"

namespace sonarcal::data_io {

// Fields "name=value", each after its u32 length.
class Ros1Fields {
 public:
  // Throws DataError if a length leads out of `bytes`, or a field has no '='. `bytes` must outlive it.
  Ros1Fields(std::span<const std::byte> bytes, std::string file, std::uint64_t file_offset);

  // Value of a field of that size. Throws DataError if it is missing or has another size.
  std::uint8_t U8(std::string_view name) const;
  std::uint32_t U32(std::string_view name) const;
  std::string Text(std::string_view name) const;
  bool Has(std::string_view name) const;

 private:
  ByteReader Value(std::string_view name) const;

  std::string file_;
  std::uint64_t file_offset_;
  std::vector<std::pair<std::string, std::span<const std::byte>>> fields_;
};

// Max size of a record's header. Real headers have about a hundred bytes plus a topic's name.
inline constexpr std::uint64_t kMostRos1HeaderBytes = 1 << 16;

enum class Ros1Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndexData = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7,
};

}  // namespace sonarcal::data_io
