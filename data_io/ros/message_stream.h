// Reads the fields of one ROS message in sequence from its serialised bytes, of either encoding:
//
//   kRos1  ROS 1 serialization: packed, little-endian; a string is a u32 length and its bytes
//   kCdr   ROS 2's plain CDR: 4 bytes of encapsulation (0, 0 or 1 = big- or little-endian, two of options),
//          then primitives aligned to their size, counted from the end of the encapsulation; the length of a
//          string includes the NUL at its end
//
// A decoder (data_io/ros/ros_messages.h) then names a message's fields once. Every length is compared with
// the remaining bytes before any allocation. A DataError names message, byte and field.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "data_io/files/byte_reader.h"

namespace sonarcal::data_io {

enum class MessageEncoding { kRos1, kCdr };

class MessageStream {
 public:
  // `bytes` must outlive the stream. `where` starts its messages: "dive.bag: /sonar: message 3". Throws
  // DataError if the encapsulation is not plain CDR.
  MessageStream(std::span<const std::byte> bytes, MessageEncoding encoding, std::string where);

  MessageEncoding encoding() const { return encoding_; }

  std::uint8_t U8(std::string_view field) { return Integer<std::uint8_t>(field); }
  std::uint16_t U16(std::string_view field) { return Integer<std::uint16_t>(field); }
  std::uint32_t U32(std::string_view field) { return Integer<std::uint32_t>(field); }
  std::uint64_t U64(std::string_view field) { return Integer<std::uint64_t>(field); }
  std::int16_t I16(std::string_view field);
  float F32(std::string_view field);   // any bit pattern, NaN included
  double F64(std::string_view field);  // any bit pattern, NaN included

  std::string String(std::string_view field);

  // Number of elements of a sequence. Each takes at least `min_bytes`.
  std::uint32_t Count(std::string_view field, std::uint64_t min_bytes);

  std::vector<float> F32s(std::string_view field);
  std::vector<std::int16_t> I16s(std::string_view field);
  std::span<const std::byte> Bytes(std::string_view field);  // u8[], inside the message's bytes

  // Throws DataError if bytes remain, i.e. the message has another definition. CDR may pad its end.
  void Finish() const;

  // "where: byte N: field", with N the next byte.
  std::string Where(std::string_view field) const { return reader_.Where(at_, field); }

 private:
  template <typename T>
  T Integer(std::string_view field);
  void Align(std::uint64_t size);

  ByteReader reader_;
  MessageEncoding encoding_;
  bool big_endian_ = false;
  std::uint64_t at_ = 0;
};

}  // namespace sonarcal::data_io
