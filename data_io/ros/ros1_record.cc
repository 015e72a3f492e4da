#include "data_io/ros/ros1_record.h"

#include <algorithm>
#include <utility>

#include "core/types/error.h"
#include "core/types/printable.h"

namespace sonarcal::data_io {

Ros1Fields::Ros1Fields(std::span<const std::byte> bytes, std::string file, std::uint64_t file_offset)
    : file_(std::move(file)), file_offset_(file_offset) {
  const ByteReader reader(bytes, file_, file_offset);
  for (std::uint64_t at = 0; at < bytes.size();) {
    const std::uint32_t length = reader.U32(at, "length of a field");
    const std::span<const std::byte> field = reader.Bytes(at + 4, length, "field");
    const auto equals = std::ranges::find(field, std::byte{'='});
    if (equals == field.end()) {
      throw DataError("{}: no '=' in it, expected name=value", reader.Where(at + 4, "field"));
    }
    const auto name_bytes = static_cast<std::size_t>(equals - field.begin());
    fields_.emplace_back(std::string(reinterpret_cast<const char*>(field.data()), name_bytes),
                         field.subspan(name_bytes + 1));
    at += 4 + std::uint64_t{length};
  }
}

bool Ros1Fields::Has(std::string_view name) const {
  return std::ranges::any_of(fields_, [&](const auto& field) { return field.first == name; });
}

ByteReader Ros1Fields::Value(std::string_view name) const {
  for (const auto& [known, value] : fields_) {
    if (known == name) return {value, file_, file_offset_};
  }
  throw DataError("{}: byte {}: header of a record: no field '{}', expected one", file_, file_offset_, name);
}

std::uint8_t Ros1Fields::U8(std::string_view name) const {
  return Value(name).U8(0, name);
}

std::uint32_t Ros1Fields::U32(std::string_view name) const {
  return Value(name).U32(0, name);
}

std::string Ros1Fields::Text(std::string_view name) const {
  const ByteReader value = Value(name);
  const std::span<const std::byte> bytes = value.Bytes(0, value.size(), name);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace sonarcal::data_io
