#include "data_io/ros/message_stream.h"

#include <bit>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::data_io {
namespace {

constexpr std::uint64_t kEncapsulationBytes = 4;
constexpr std::uint64_t kMaxPaddingBytes = 7;  // largest alignment of CDR minus one

}  // namespace

MessageStream::MessageStream(std::span<const std::byte> bytes, MessageEncoding encoding, std::string where)
    : reader_(bytes, std::move(where)), encoding_(encoding) {
  if (encoding == MessageEncoding::kRos1) return;
  const std::uint8_t high = reader_.U8(0, "encapsulation");
  const std::uint8_t low = reader_.U8(1, "encapsulation");
  if (high != 0 || low > 1) {
    throw DataError("{}: {:#04x} {:#04x}, expected 0x00 and 0x00 or 0x01 (plain CDR)",
                    reader_.Where(0, "encapsulation"), high, low);
  }
  big_endian_ = low == 0;
  reader_.Bytes(0, kEncapsulationBytes, "encapsulation");
  at_ = kEncapsulationBytes;
}

void MessageStream::Align(std::uint64_t size) {
  if (encoding_ == MessageEncoding::kRos1) return;
  const std::uint64_t from_origin = at_ - kEncapsulationBytes;
  at_ = kEncapsulationBytes + (from_origin + size - 1) / size * size;
}

template <typename T>
T MessageStream::Integer(std::string_view field) {
  Align(sizeof(T));
  T value = 0;
  int place = 0;
  for (const std::byte byte : reader_.Bytes(at_, sizeof(T), field)) {
    const int shift = 8 * (big_endian_ ? static_cast<int>(sizeof(T)) - 1 - place : place);
    value = static_cast<T>(value | static_cast<T>(std::to_integer<T>(byte) << shift));
    ++place;
  }
  at_ += sizeof(T);
  return value;
}

template std::uint8_t MessageStream::Integer(std::string_view);
template std::uint16_t MessageStream::Integer(std::string_view);
template std::uint32_t MessageStream::Integer(std::string_view);
template std::uint64_t MessageStream::Integer(std::string_view);

std::int16_t MessageStream::I16(std::string_view field) {
  return std::bit_cast<std::int16_t>(U16(field));
}

float MessageStream::F32(std::string_view field) {
  return std::bit_cast<float>(U32(field));
}

double MessageStream::F64(std::string_view field) {
  return std::bit_cast<double>(U64(field));
}

std::uint32_t MessageStream::Count(std::string_view field, std::uint64_t min_bytes) {
  const std::uint32_t count = U32(field);
  const std::uint64_t left = reader_.size() - at_;
  if (count * min_bytes > left) {
    throw DataError("{}: {} elements of at least {} bytes, but {} bytes are left",
                    reader_.Where(at_ - sizeof(count), field), count, min_bytes, left);
  }
  return count;
}

std::string MessageStream::String(std::string_view field) {
  const std::span<const std::byte> bytes = Bytes(field);
  std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (encoding_ == MessageEncoding::kCdr && !text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

std::span<const std::byte> MessageStream::Bytes(std::string_view field) {
  const std::uint32_t count = Count(field, 1);
  const std::span<const std::byte> bytes = reader_.Bytes(at_, count, field);
  at_ += count;
  return bytes;
}

std::vector<float> MessageStream::F32s(std::string_view field) {
  std::vector<float> values(Count(field, sizeof(float)));
  for (float& value : values) value = F32(field);
  return values;
}

std::vector<std::int16_t> MessageStream::I16s(std::string_view field) {
  std::vector<std::int16_t> values(Count(field, sizeof(std::int16_t)));
  for (std::int16_t& value : values) value = I16(field);
  return values;
}

void MessageStream::Finish() const {
  const std::uint64_t left = reader_.size() - at_;
  if (left <= (encoding_ == MessageEncoding::kCdr ? kMaxPaddingBytes : 0)) return;
  throw DataError("{}: {} bytes are left, expected none: the message has another definition",
                  reader_.Where(at_, "end of the message"), left);
}

}  // namespace sonarcal::data_io
