// Writes the fields of one ROS message in sequence, in either encoding. Counterpart of
// data_io/ros/message_stream.h, which describes the encodings. CDR is little-endian.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/types/error.h"
#include "data_io/ros/message_stream.h"
#include "data_io/ros/ros_messages.h"

namespace sonarcal::data_io {

class MessageBuilder {
 public:
  explicit MessageBuilder(MessageEncoding encoding) : encoding_(encoding) {
    if (encoding == MessageEncoding::kCdr) bytes_ = std::string{'\0', '\1', '\0', '\0'};
  }

  template <typename T>
  MessageBuilder& Number(T value) {
    static_assert(std::is_arithmetic_v<T>);
    if (encoding_ == MessageEncoding::kCdr) {
      // Aligned to the size of the number, counted from the end of the encapsulation, which has 4 bytes.
      while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_ += '\0';
    }
    const auto* raw = reinterpret_cast<const char*>(&value);
    if constexpr (std::endian::native == std::endian::big) {
      for (std::size_t i = sizeof(T); i > 0; --i) bytes_ += raw[i - 1];
    } else {
      bytes_.append(raw, sizeof(T));
    }
    return *this;
  }

  // Throws DataError if a sequence has more elements than ROS can count.
  MessageBuilder& Count(std::size_t count) {
    if (count > std::numeric_limits<std::uint32_t>::max())
      throw DataError("a message of {} elements, expected at most 2^32 - 1 for ROS", count);
    return Number(static_cast<std::uint32_t>(count));
  }

  MessageBuilder& Text(std::string_view text) {
    const bool is_cdr = encoding_ == MessageEncoding::kCdr;
    Count(text.size() + (is_cdr ? 1 : 0));
    bytes_ += text;
    if (is_cdr) bytes_ += '\0';
    return *this;
  }

  // A sequence of bytes: u8[].
  MessageBuilder& Bytes(std::string_view bytes) {
    Count(bytes.size());
    bytes_ += bytes;
    return *this;
  }

  // builtin_interfaces/Time.
  MessageBuilder& Time(std::int64_t time_ns) {
    return Number(static_cast<std::uint32_t>(time_ns / kNsPerS))
        .Number(static_cast<std::uint32_t>(time_ns % kNsPerS));
  }

  // std_msgs/Header. The sequence number exists in ROS 1 only.
  MessageBuilder& Header(std::uint32_t sequence, std::int64_t stamp_ns, std::string_view frame) {
    if (encoding_ == MessageEncoding::kRos1) Number(sequence);
    return Time(stamp_ns).Text(frame);
  }

  std::string Take() { return std::move(bytes_); }

 private:
  MessageEncoding encoding_;
  std::string bytes_;
};

}  // namespace sonarcal::data_io
