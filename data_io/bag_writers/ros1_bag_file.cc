#include "data_io/bag_writers/ros1_bag_file.h"

#include <algorithm>
#include <cerrno>
#include <span>
#include <utility>
#include <vector>

#include "core/types/error.h"
#include "data_io/files/byte_reader.h"
#include "data_io/files/compression.h"
#include "data_io/files/file_bytes.h"
#include "data_io/ros/ros1_records.h"
#include "data_io/ros/ros_messages.h"

namespace sonarcal::data_io {
namespace {

constexpr std::size_t kChunkBytes = 768 << 10;      // a chunk is closed when it has as many, as rosbag does
constexpr std::size_t kBagHeaderBytes = 4096;       // of the whole record, blanks included
constexpr std::size_t kMaxMessageBytes = 1U << 31;  // sizes and offsets have 32 bits

std::string U32(std::uint64_t value) {
  return LittleEndianBytes(value, 4);
}

std::string Time(std::int64_t time_ns) {
  const auto time = static_cast<std::uint64_t>(time_ns);
  return U32(time / kNsPerS) + U32(time % kNsPerS);
}

using Field = std::pair<std::string_view, std::string>;

std::string FieldBytes(std::span<const Field> fields) {
  std::string bytes;
  for (const auto& [name, value] : fields) {
    bytes += U32(name.size() + 1 + value.size());
    bytes += name;
    bytes += '=' + value;
  }
  return bytes;
}

std::string RecordBytes(Ros1Op op, std::vector<Field> fields, std::string_view data) {
  fields.emplace_back("op", std::string(1, static_cast<char>(op)));
  const std::string header = FieldBytes(fields);
  std::string record = U32(header.size()) + header + U32(data.size());
  record += data;
  return record;
}

}  // namespace

Ros1BagFile::Ros1BagFile(const std::filesystem::path& file)
    : name_(file.string()), stream_(file, std::ios::binary) {
  Put(kRos1Magic);
  PutBagHeader(0);
}

std::uint32_t Ros1BagFile::AddConnection(const Ros1Connection& connection) {
  const std::vector<Field> about = {{"topic", connection.topic},
                                    {"type", connection.type},
                                    {"md5sum", connection.md5},
                                    {"message_definition", connection.definition}};
  const std::string record = RecordBytes(
      Ros1Op::kConnection, {{"conn", U32(connections_)}, {"topic", connection.topic}}, FieldBytes(about));
  connection_records_ += record;
  chunk_ += record;
  return connections_++;
}

void Ros1BagFile::Write(std::uint32_t connection, std::int64_t time_ns, std::string_view message) {
  if (message.size() > kMaxMessageBytes) {
    throw DataError("{}: a message of {} bytes, expected at most {} for a bag of ROS 1", name_,
                    message.size(), kMaxMessageBytes);
  }
  first_ns_ = index_.empty() ? time_ns : std::min(first_ns_, time_ns);
  last_ns_ = index_.empty() ? time_ns : std::max(last_ns_, time_ns);
  Index& index = index_[connection];
  ++index.count;
  index.entries += Time(time_ns) + U32(chunk_.size());
  chunk_ += RecordBytes(Ros1Op::kMessage, {{"conn", U32(connection)}, {"time", Time(time_ns)}}, message);
  if (chunk_.size() >= kChunkBytes) FlushChunk();
}

void Ros1BagFile::Close() {
  if (!index_.empty()) FlushChunk();
  const std::uint64_t index_at = offset_;
  Put(connection_records_);
  Put(chunk_infos_);
  stream_.seekp(static_cast<std::streamoff>(kRos1Magic.size()));
  PutBagHeader(index_at);
  stream_.close();
  if (!stream_) FailToWrite(name_);
}

void Ros1BagFile::Put(std::string_view bytes) {
  errno = 0;
  stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream_) FailToWrite(name_);
  offset_ += bytes.size();
}

void Ros1BagFile::PutBagHeader(std::uint64_t index_at) {
  const auto record = [&](std::size_t blanks) {
    return RecordBytes(Ros1Op::kBagHeader,
                       {{"index_pos", LittleEndianBytes(index_at, 8)},
                        {"conn_count", U32(connections_)},
                        {"chunk_count", U32(chunks_)}},
                       std::string(blanks, ' '));
  };
  Put(record(kBagHeaderBytes - record(0).size()));
}

void Ros1BagFile::FlushChunk() {
  const std::uint64_t chunk_at = offset_;
  const std::vector<std::byte> packed = Compress(Codec::kLz4, std::as_bytes(std::span(chunk_)));
  Put(RecordBytes(Ros1Op::kChunk, {{"compression", "lz4"}, {"size", U32(chunk_.size())}},
                  {reinterpret_cast<const char*>(packed.data()), packed.size()}));
  std::string counts;
  for (const auto& [connection, index] : index_) {
    const std::string count = U32(index.count);
    Put(RecordBytes(Ros1Op::kIndexData, {{"ver", U32(1)}, {"conn", U32(connection)}, {"count", count}},
                    index.entries));
    counts += U32(connection) + count;
  }
  chunk_infos_ += RecordBytes(Ros1Op::kChunkInfo,
                              {{"ver", U32(1)},
                               {"chunk_pos", LittleEndianBytes(chunk_at, 8)},
                               {"start_time", Time(first_ns_)},
                               {"end_time", Time(last_ns_)},
                               {"count", U32(index_.size())}},
                              counts);
  ++chunks_;
  chunk_.clear();
  index_.clear();
}

}  // namespace sonarcal::data_io
