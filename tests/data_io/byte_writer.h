// Builds binary files for tests: little-endian values put at an offset, the bytes between being zero.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>

namespace sonarcal::testing {

class ByteWriter {
 public:
  void U8(std::size_t offset, std::uint8_t value) { Put(offset, value, 1); }
  void U16(std::size_t offset, std::uint16_t value) { Put(offset, value, 2); }
  void I16(std::size_t offset, std::int16_t value) { Put(offset, std::bit_cast<std::uint16_t>(value), 2); }
  void U32(std::size_t offset, std::uint32_t value) { Put(offset, value, 4); }
  void U64(std::size_t offset, std::uint64_t value) { Put(offset, value, 8); }
  void F32(std::size_t offset, float value) { Put(offset, std::bit_cast<std::uint32_t>(value), 4); }
  void F64(std::size_t offset, double value) { Put(offset, std::bit_cast<std::uint64_t>(value), 8); }

  // Lengthens the file to `size` bytes.
  void Grow(std::size_t size) {
    if (bytes_.size() < size) bytes_.resize(size, '\0');
  }

  const std::string& bytes() const { return bytes_; }

 private:
  void Put(std::size_t offset, std::uint64_t value, std::size_t count) {
    Grow(offset + count);
    for (std::size_t i = 0; i < count; ++i) bytes_[offset + i] = static_cast<char>(value >> (8 * i));
  }

  std::string bytes_;
};

}  // namespace sonarcal::testing
