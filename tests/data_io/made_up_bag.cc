#include "tests/data_io/made_up_bag.h"

#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <map>
#include <stdexcept>
#include <utility>

namespace sonarcal::testing {
namespace {

std::string Little(std::uint64_t value, std::size_t size) {
  std::string bytes;
  for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(value >> 8 * i);
  return bytes;
}

std::string U32(std::uint64_t value) {
  return Little(value, 4);
}

using Fields = std::vector<std::pair<std::string, std::string>>;

std::string FieldBytes(const Fields& fields) {
  std::string bytes;
  for (const auto& [name, value] : fields) bytes += U32(name.size() + 1 + value.size()) + name + "=" + value;
  return bytes;
}

std::string RecordBytes(char op, Fields fields, const std::string& data) {
  fields.insert(fields.begin(), {"op", std::string(1, op)});
  const std::string header = FieldBytes(fields);
  return U32(header.size()) + header + U32(data.size()) + data;
}

std::string Time(std::int64_t time_ns) {
  return U32(static_cast<std::uint64_t>(time_ns / 1'000'000'000)) +
         U32(static_cast<std::uint64_t>(time_ns % 1'000'000'000));
}

}  // namespace

std::string PackedBytes(const std::string& bytes, const std::string& compression) {
  std::string packed;
  const auto keep = [&](std::size_t size, bool is_error) {
    if (is_error) throw std::runtime_error("compression");
    packed.resize(size);
  };
  if (compression == "lz4") {
    packed.resize(LZ4F_compressFrameBound(bytes.size(), nullptr));
    const std::size_t size =
        LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr);
    keep(size, LZ4F_isError(size) != 0);
  } else if (compression == "zstd") {
    packed.resize(ZSTD_compressBound(bytes.size()));
    const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 1);
    keep(size, ZSTD_isError(size) != 0);
  } else if (compression == "bz2") {
    packed.resize(bytes.size() + bytes.size() / 100 + 600);  // never more, as the library's manual says
    auto size = static_cast<unsigned>(packed.size());
    std::string input = bytes;
    const int result = BZ2_bzBuffToBuffCompress(packed.data(), &size, input.data(),
                                                static_cast<unsigned>(input.size()), 9, 0, 0);
    keep(size, result != BZ_OK);
  } else {
    packed = bytes;
  }
  return packed;
}

std::string Ros1BagBytes(const std::vector<MadeUpMessage>& messages, const MadeUpRos1Bag& bag) {
  std::map<std::string, std::uint32_t> ids;
  std::string connections;
  std::string infos;
  std::uint32_t chunks = 0;
  std::string body;
  constexpr std::size_t kMagicBytes = 13;
  constexpr std::size_t kBagHeaderBytes = 4096;
  for (std::size_t first = 0; first < messages.size(); first += bag.messages_a_chunk) {
    std::string chunk;
    std::map<std::uint32_t, std::pair<std::uint32_t, std::string>> index;
    for (std::size_t i = first; i < std::min(messages.size(), first + bag.messages_a_chunk); ++i) {
      const MadeUpMessage& message = messages[i];
      if (!ids.contains(message.topic)) {
        const auto id = static_cast<std::uint32_t>(ids.size());
        ids[message.topic] = id;
        const std::string record = RecordBytes(7, {{"conn", U32(id)}, {"topic", message.topic}},
                                               FieldBytes({{"topic", message.topic},
                                                           {"type", message.type},
                                                           {"md5sum", "0123456789abcdef0123456789abcdef"},
                                                           {"message_definition", "uint8 of_no_matter\n"}}));
        connections += record;
        chunk += record;
      }
      const std::uint32_t id = ids[message.topic];
      index[id].first += 1;
      index[id].second += Time(message.log_time_ns) + U32(chunk.size());
      chunk += RecordBytes(2, {{"conn", U32(id)}, {"time", Time(message.log_time_ns)}}, message.bytes);
    }
    const std::uint64_t chunk_at = kMagicBytes + kBagHeaderBytes + body.size();
    body += RecordBytes(5, {{"compression", bag.compression}, {"size", U32(chunk.size())}},
                        PackedBytes(chunk, bag.compression));
    std::string counts;
    for (const auto& [id, entries] : index) {
      body +=
          RecordBytes(4, {{"ver", U32(1)}, {"conn", U32(id)}, {"count", U32(entries.first)}}, entries.second);
      counts += U32(id) + U32(entries.first);
    }
    infos += RecordBytes(6,
                         {{"ver", U32(1)},
                          {"chunk_pos", Little(chunk_at, 8)},
                          {"start_time", Time(0)},
                          {"end_time", Time(0)},
                          {"count", U32(index.size())}},
                         counts);
    ++chunks;
  }
  const std::uint64_t index_at = bag.with_end ? kMagicBytes + kBagHeaderBytes + body.size() : 0;
  std::string header = RecordBytes(3,
                                   {{"index_pos", Little(index_at, 8)},
                                    {"conn_count", U32(ids.size())},
                                    {"chunk_count", U32(chunks)},
                                    {"encryptor", bag.encrypted ? "rosbag/AesCbcEncryptor" : ""}},
                                   "");
  // Blanks fill the bag's header up, so that it can be written again at the end.
  const std::size_t blanks = kBagHeaderBytes - header.size();
  header.replace(header.size() - 4, 4, U32(blanks));
  header += std::string(blanks, ' ');
  return "#ROSBAG V2.0\n" + header + body + (bag.with_end ? connections + infos : "");
}

void WriteRos2Bag(const std::filesystem::path& file, const std::vector<MadeUpMessage>& messages,
                  const std::string& more_sql) {
  std::filesystem::remove(file);
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
  const auto run = [&](const std::string& sql) {
    ASSERT_EQ(sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(db);
  };
  run("PRAGMA page_size=512; PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF;"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
      " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,"
      " data BLOB NOT NULL); CREATE INDEX timestamp_idx ON messages (timestamp ASC);");
  std::map<std::string, int> ids;
  for (const MadeUpMessage& message : messages) {
    if (!ids.contains(message.topic)) {
      const int id = static_cast<int>(ids.size()) + 1;
      ids[message.topic] = id;
      std::string type = message.type;
      type.replace(type.find('/'), 1, "/msg/");
      run("INSERT INTO topics VALUES(" + std::to_string(id) + ", '" + message.topic + "', '" + type +
          "', 'cdr', '')");
    }
    sqlite3_stmt* insert = nullptr;
    ASSERT_EQ(sqlite3_prepare_v2(db, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", -1,
                                 &insert, nullptr),
              SQLITE_OK);
    sqlite3_bind_int(insert, 1, ids[message.topic]);
    sqlite3_bind_int64(insert, 2, message.log_time_ns);
    sqlite3_bind_blob(insert, 3, message.bytes.data(), static_cast<int>(message.bytes.size()),
                      SQLITE_TRANSIENT);
    ASSERT_EQ(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_finalize(insert);
  }
  if (!more_sql.empty()) run(more_sql);
  sqlite3_close(db);
}

}  // namespace sonarcal::testing
