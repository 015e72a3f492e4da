// Serialised ROS messages for tests, put together primitive by primitive: packed as ROS 1 does, or CDR of
// either byte order.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

namespace sonarcal::testing {

enum class Wire { kRos1, kCdrLittle, kCdrBig };
inline constexpr Wire kWires[] = {Wire::kRos1, Wire::kCdrLittle, Wire::kCdrBig};

class MessageWriter {
 public:
  explicit MessageWriter(Wire wire) : wire_(wire) {
    if (wire != Wire::kRos1) bytes_ = std::string{'\0', wire == Wire::kCdrLittle ? '\1' : '\0', '\0', '\0'};
  }

  MessageWriter& U8(std::uint8_t value) { return Put(value, 1); }
  MessageWriter& U16(std::uint16_t value) { return Put(value, 2); }
  MessageWriter& U32(std::uint32_t value) { return Put(value, 4); }
  MessageWriter& U64(std::uint64_t value) { return Put(value, 8); }
  MessageWriter& F32(float value) { return Put(std::bit_cast<std::uint32_t>(value), 4); }
  MessageWriter& F64(double value) { return Put(std::bit_cast<std::uint64_t>(value), 8); }
  MessageWriter& String(const std::string& text) {
    const bool ros1 = wire_ == Wire::kRos1;
    U32(static_cast<std::uint32_t>(text.size() + (ros1 ? 0 : 1)));
    bytes_ += text;
    if (!ros1) bytes_ += '\0';
    return *this;
  }
  MessageWriter& Blob(const std::string& bytes) {
    U32(static_cast<std::uint32_t>(bytes.size()));
    bytes_ += bytes;
    return *this;
  }
  MessageWriter& F32s(const std::vector<float>& values) {
    U32(static_cast<std::uint32_t>(values.size()));
    for (const float value : values) F32(value);
    return *this;
  }
  // std_msgs/Header
  MessageWriter& Header(std::uint32_t seconds, std::uint32_t nanoseconds, const std::string& frame_id) {
    if (wire_ == Wire::kRos1) U32(7);  // sequence number
    return U32(seconds).U32(nanoseconds).String(frame_id);
  }

  const std::string& bytes() const { return bytes_; }

 private:
  MessageWriter& Put(std::uint64_t value, std::size_t size) {
    if (wire_ != Wire::kRos1) {
      while ((bytes_.size() - 4) % size != 0) bytes_ += '\0';
    }
    for (std::size_t i = 0; i < size; ++i)
      bytes_ += static_cast<char>(value >> 8 * (wire_ == Wire::kCdrBig ? size - 1 - i : i));
    return *this;
  }

  Wire wire_;
  std::string bytes_;
};

}  // namespace sonarcal::testing
