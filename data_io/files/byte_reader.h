// Little-endian binary data, read by offset. Every access is checked.
//
// The layout of a format is a list of offsets, so a field is read by its offset and its name. If it does not
// lie completely inside the data, a DataError names file, byte and field:
//
//   const ByteReader header(bytes, "sample.aris", 1024);
//   const std::uint32_t ping_mode = header.U32(436, "PingMode");
//
// Independent of the machine's byte order and alignment: values are assembled byte by byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonarcal::data_io {

class ByteReader {
 public:
  // `bytes` must outlive the reader. `file` and `file_offset` (the position of `bytes` in it) are for
  // messages.
  ByteReader(std::span<const std::byte> bytes, std::string file, std::uint64_t file_offset = 0)
      : bytes_(bytes), file_(std::move(file)), file_offset_(file_offset) {}

  std::size_t size() const { return bytes_.size(); }
  const std::string& file() const { return file_; }
  std::uint64_t file_offset() const { return file_offset_; }

  std::uint8_t U8(std::uint64_t offset, std::string_view field) const;
  std::uint16_t U16(std::uint64_t offset, std::string_view field) const;
  std::uint32_t U32(std::uint64_t offset, std::string_view field) const;
  std::uint64_t U64(std::uint64_t offset, std::string_view field) const;
  std::int16_t I16(std::uint64_t offset, std::string_view field) const;
  std::int32_t I32(std::uint64_t offset, std::string_view field) const;
  float F32(std::uint64_t offset, std::string_view field) const;   // any bit pattern, NaN included
  double F64(std::uint64_t offset, std::string_view field) const;  // any bit pattern, NaN included

  // Throws DataError if the value is outside lowest..highest.
  std::uint32_t U32Within(std::uint64_t offset, std::string_view field, std::uint32_t lowest,
                          std::uint32_t highest) const;
  std::int32_t I32Within(std::uint64_t offset, std::string_view field, std::int32_t lowest,
                         std::int32_t highest) const;

  // `count` bytes from `offset`.
  std::span<const std::byte> Bytes(std::uint64_t offset, std::uint64_t count, std::string_view field) const;

  // "file: byte N: field": the start of a message about a field.
  std::string Where(std::uint64_t offset, std::string_view field) const;

 private:
  template <typename T>
  T Integer(std::uint64_t offset, std::string_view field) const;
  template <typename T>
  T Within(T value, std::uint64_t offset, std::string_view field, T lowest, T highest) const;

  std::span<const std::byte> bytes_;
  std::string file_;
  std::uint64_t file_offset_;
};

// Unsigned little-endian integer of 1 to 4 bytes.
std::uint32_t LittleEndian(std::span<const std::byte> bytes);

// The lowest `size` bytes of a number, in this order.
std::string LittleEndianBytes(std::uint64_t value, int size);

// Length of a regular file in bytes. Throws DataError if there is no regular file.
std::uint64_t RegularFileSize(const std::filesystem::path& file);

// `count` bytes of a file from `offset`. The caller has checked `count` against the file's size. Throws
// DataError, naming `what`, if they cannot be read. Opens the file each time, so any number of threads may
// read one file.
std::vector<std::byte> ReadFileRange(const std::filesystem::path& file, std::uint64_t offset,
                                     std::size_t count, std::string_view what);

}  // namespace sonarcal::data_io
