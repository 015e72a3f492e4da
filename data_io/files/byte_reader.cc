#include "data_io/files/byte_reader.h"

#include <bit>
#include <fstream>
#include <system_error>

#include "core/types/error.h"

namespace sonarcal::data_io {

template <typename T>
T ByteReader::Integer(std::uint64_t offset, std::string_view field) const {
  T value = 0;
  int shift = 0;
  for (const std::byte byte : Bytes(offset, sizeof(T), field)) {
    value = static_cast<T>(value | static_cast<T>(std::to_integer<T>(byte) << shift));
    shift += 8;
  }
  return value;
}

template <typename T>
T ByteReader::Within(T value, std::uint64_t offset, std::string_view field, T lowest, T highest) const {
  if (value < lowest || value > highest)
    throw DataError("{}: {}, expected {}..{}", Where(offset, field), value, lowest, highest);
  return value;
}

std::uint32_t ByteReader::U32Within(std::uint64_t offset, std::string_view field, std::uint32_t lowest,
                                    std::uint32_t highest) const {
  return Within(U32(offset, field), offset, field, lowest, highest);
}

std::int32_t ByteReader::I32Within(std::uint64_t offset, std::string_view field, std::int32_t lowest,
                                   std::int32_t highest) const {
  return Within(I32(offset, field), offset, field, lowest, highest);
}

std::int32_t ByteReader::I32(std::uint64_t offset, std::string_view field) const {
  return static_cast<std::int32_t>(U32(offset, field));
}

std::uint8_t ByteReader::U8(std::uint64_t offset, std::string_view field) const {
  return Integer<std::uint8_t>(offset, field);
}

std::uint16_t ByteReader::U16(std::uint64_t offset, std::string_view field) const {
  return Integer<std::uint16_t>(offset, field);
}

std::uint32_t ByteReader::U32(std::uint64_t offset, std::string_view field) const {
  return Integer<std::uint32_t>(offset, field);
}

std::uint64_t ByteReader::U64(std::uint64_t offset, std::string_view field) const {
  return Integer<std::uint64_t>(offset, field);
}

std::int16_t ByteReader::I16(std::uint64_t offset, std::string_view field) const {
  return std::bit_cast<std::int16_t>(U16(offset, field));
}

float ByteReader::F32(std::uint64_t offset, std::string_view field) const {
  return std::bit_cast<float>(U32(offset, field));
}

double ByteReader::F64(std::uint64_t offset, std::string_view field) const {
  return std::bit_cast<double>(U64(offset, field));
}

std::span<const std::byte> ByteReader::Bytes(std::uint64_t offset, std::uint64_t count,
                                             std::string_view field) const {
  if (offset > bytes_.size() || count > bytes_.size() - offset) {
    throw DataError("{}: {} bytes expected, but the data end at byte {}", Where(offset, field), count,
                    file_offset_ + bytes_.size());
  }
  return bytes_.subspan(offset, count);
}

std::string ByteReader::Where(std::uint64_t offset, std::string_view field) const {
  return fmt::format("{}: byte {}: {}", file_, file_offset_ + offset, field);
}

std::uint32_t LittleEndian(std::span<const std::byte> bytes) {
  SONARCAL_CHECK(!bytes.empty() && bytes.size() <= sizeof(std::uint32_t), "{} bytes", bytes.size());
  std::uint32_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | std::to_integer<std::uint32_t>(bytes[i]);
  return value;
}

std::string LittleEndianBytes(std::uint64_t value, int size) {
  std::string bytes;
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> 8 * i & 0xff);
  return bytes;
}

std::uint64_t RegularFileSize(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw DataError("{}: no such file", file.string());
  if (!std::filesystem::is_regular_file(status)) {
    throw DataError("{}: not a regular file, expected one", file.string());
  }
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) throw DataError("{}: its size cannot be determined: {}", file.string(), error.message());
  return size;
}

std::vector<std::byte> ReadFileRange(const std::filesystem::path& file, std::uint64_t offset,
                                     std::size_t count, std::string_view what) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw DataError("{}: cannot be opened for reading", file.string());
  std::vector<std::byte> bytes(count);
  stream.seekg(static_cast<std::streamoff>(offset));
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count));
  if (static_cast<std::size_t>(stream.gcount()) != count) {
    throw DataError("{}: byte {}: {}: {} bytes could be read, expected {}", file.string(), offset, what,
                    stream.gcount(), count);
  }
  return bytes;
}

}  // namespace sonarcal::data_io
