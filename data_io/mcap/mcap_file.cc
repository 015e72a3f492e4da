#include "data_io/mcap/mcap_file.h"

#include <algorithm>

#include "core/types/error.h"
#include "data_io/files/byte_reader.h"
#include "data_io/mcap/mcap_records.h"

namespace sonarcal::data_io {

McapFile::McapFile(std::filesystem::path file, std::string name, std::uint64_t max_message_bytes)
    : file_(std::move(file)),
      name_(std::move(name)),
      file_bytes_(RegularFileSize(file_)),
      max_message_bytes_(max_message_bytes),
      index_(ReadMcapIndex(file_, name_, max_message_bytes)) {}

std::vector<std::byte> McapFile::Read(const McapMessage& message, std::uint64_t wanted_bytes) const {
  constexpr std::uint64_t kHeadBytes = kMcapRecordHeadBytes + kMcapMessageHeadBytes;
  const std::uint64_t at = message.position;
  if (message.container == 0) {
    const std::uint64_t rest = file_bytes_ - std::min(at, file_bytes_);
    const std::vector<std::byte> head = ReadFileRange(file_, at, std::min(rest, kHeadBytes), "message");
    const std::uint64_t data_bytes = DataBytes(message, {head, name_, at}, rest);
    return ReadFileRange(file_, at + kHeadBytes, std::min(data_bytes, wanted_bytes), "message");
  }
  const std::shared_ptr<const McapContent> content = ContentOf(message.container - 1);
  const std::string where = McapChunkName(name_, index_.chunks.at(message.container - 1));
  const std::uint64_t rest = content->bytes.size() - std::min<std::uint64_t>(at, content->bytes.size());
  const std::span<const std::byte> bytes = std::span(content->bytes).last(rest);
  const std::uint64_t data_bytes =
      DataBytes(message, {bytes.first(std::min(rest, kHeadBytes)), where, at}, rest);
  const auto data = bytes.subspan(kHeadBytes, std::min(data_bytes, wanted_bytes));
  return {data.begin(), data.end()};
}

// Number of bytes of the data of a message, of whose record `rest_bytes` are there. Throws DataError if the
// record is not this message, or not there as a whole.
std::uint64_t McapFile::DataBytes(const McapMessage& message, const ByteReader& head,
                                  std::uint64_t rest_bytes) const {
  const std::uint8_t kind = head.U8(0, "kind of a record");
  const std::uint64_t bytes = head.U64(1, "length of a message");
  const auto time_ns = static_cast<std::int64_t>(head.U64(kMcapRecordHeadBytes + 6, "log time of a message"));
  if (kind != static_cast<std::uint8_t>(McapKind::kMessage) || time_ns != message.log_time_ns) {
    throw DataError("{}: a record of kind {} and time {}, expected a message of time {}",
                    head.Where(0, "message"), kind, time_ns, message.log_time_ns);
  }
  const std::uint64_t there = rest_bytes - kMcapRecordHeadBytes;
  if (bytes < kMcapMessageHeadBytes || bytes > max_message_bytes_) {
    throw DataError("{}: {}, expected {} to {}", head.Where(1, "length of a message"), bytes,
                    kMcapMessageHeadBytes, max_message_bytes_);
  }
  if (bytes > there) {
    throw DataError("{}: {}, of which {} are there: the file was cut off",
                    head.Where(1, "length of a message"), bytes, there);
  }
  head.Bytes(0, kMcapRecordHeadBytes + kMcapMessageHeadBytes, "message");
  return bytes - kMcapMessageHeadBytes;
}

std::shared_ptr<const McapContent> McapFile::ContentOf(std::uint64_t chunk) const {
  const std::lock_guard lock(mutex_);
  if (!content_ || content_chunk_ != chunk) {
    content_ = std::make_shared<const McapContent>(
        ReadMcapChunk(file_, name_, index_.chunks.at(chunk), max_message_bytes_));
    content_chunk_ = chunk;
  }
  if (!content_->fault.empty()) throw DataError("{}", content_->fault);
  return content_;
}

}  // namespace sonarcal::data_io
