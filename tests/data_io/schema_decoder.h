// Reads MCAP files as a program does that knows no message: records by the specification, messages by the
// definitions that the file itself holds. Written without the code that is tested.
#pragma once

#include <zlib.h>
#include <zstd.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace sonarcal::testing {

inline void Require(bool condition, const std::string& what) {
  if (!condition) throw std::runtime_error(what);
}

// Little-endian values in sequence. With `cdr` they are aligned to their size.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes, bool cdr = false) : bytes_(bytes), cdr_(cdr) {}

  template <typename T>
  T Take() {
    while (cdr_ && at_ % sizeof(T) != 0) ++at_;
    T value;
    std::memcpy(&value, Bytes(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string_view Bytes(std::size_t count) {
    Require(count <= bytes_.size() - at_, "read behind the end");
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }
  std::string_view Text() { return Bytes(Take<std::uint32_t>()); }
  std::string_view Rest() { return bytes_.substr(at_); }
  bool is_at_end() const { return at_ == bytes_.size(); }

 private:
  std::string_view bytes_;
  bool cdr_;
  std::size_t at_ = 0;
};

// Definition of a message in the language of ROS 2, with those of its nested messages.
class Schema {
 public:
  explicit Schema(const std::string& text) {
    std::istringstream lines(text);
    std::string type;  // empty: the message itself
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("====")) continue;
      if (line.starts_with("MSG: ")) {
        type = line.substr(5);
        continue;
      }
      const std::size_t space = line.find(' ');
      Require(space != std::string::npos, "no field: " + line);
      fields_[type].push_back({line.substr(0, space), line.substr(space + 1)});
    }
  }

  // The message as JSON. Sequences of bytes become numbers. All bytes must be used.
  nlohmann::json Decode(std::string_view message) const {
    Require(message.substr(0, 4) == std::string_view("\0\1\0\0", 4), "no little-endian CDR");
    Cursor cursor(message.substr(4), true);
    nlohmann::json json = DecodeType("", cursor);
    Require(cursor.is_at_end(), "bytes are left");
    return json;
  }

 private:
  struct Field {
    std::string type;
    std::string name;
  };

  nlohmann::json DecodeType(const std::string& type, Cursor& cursor) const {
    nlohmann::json json = nlohmann::json::object();
    for (const Field& field : fields_.at(type)) {
      if (!field.type.ends_with("[]")) {
        json[field.name] = DecodeValue(field.type, cursor);
        continue;
      }
      json[field.name] = nlohmann::json::array();
      const std::string element = field.type.substr(0, field.type.size() - 2);
      for (auto left = cursor.Take<std::uint32_t>(); left > 0; --left)
        json[field.name].push_back(DecodeValue(element, cursor));
    }
    return json;
  }

  nlohmann::json DecodeValue(const std::string& type, Cursor& cursor) const {
    if (type == "uint8" || type == "bool") return cursor.Take<std::uint8_t>();
    if (type == "int32") return cursor.Take<std::int32_t>();
    if (type == "uint32") return cursor.Take<std::uint32_t>();
    if (type == "float32") return cursor.Take<float>();
    if (type == "float64") return cursor.Take<double>();
    if (type == "string") {
      const std::string_view text = cursor.Text();
      Require(!text.empty() && text.back() == '\0', "a string without NUL");
      return std::string(text.substr(0, text.size() - 1));
    }
    return DecodeType(type, cursor);
  }

  std::map<std::string, std::vector<Field>> fields_;
};

struct DecodedMessage {
  std::string topic;
  std::string type;
  std::uint64_t time_ns = 0;
  nlohmann::json message;
};

struct DecodedMcap {
  std::string profile;
  std::vector<DecodedMessage> messages;
  std::map<std::string, std::string> metadata;  // of all records
};

inline std::uint32_t CrcOf(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

// Checks every CRC, and that each index entry points at its message and each summary entry at its record.
inline DecodedMcap DecodeMcap(const std::string& file) {
  const std::string_view magic("\x89MCAP0\r\n", 8);
  Require(file.starts_with(magic) && file.ends_with(magic), "no magic number");
  DecodedMcap decoded;
  std::map<int, Schema> schemas;
  std::map<int, std::string> schema_names;
  struct Channel {
    int schema;
    std::string topic;
  };
  std::map<int, Channel> channels;
  std::string inflated;               // of the last chunk
  std::map<std::size_t, char> kinds;  // of records, by their position
  std::size_t indexed = 0;
  std::size_t at = magic.size();
  const auto take_record = [&](auto&& self, char kind, std::string_view content) -> void {
    Cursor cursor(content);
    if (kind == 1) decoded.profile = cursor.Text();
    if (kind == 3) {
      const int id = cursor.Take<std::uint16_t>();
      schema_names[id] = cursor.Text();
      Require(cursor.Text() == "ros2msg", "encoding of a schema");
      schemas.emplace(id, Schema(std::string(cursor.Text())));
    }
    if (kind == 4) {
      const int id = cursor.Take<std::uint16_t>();
      const int schema = cursor.Take<std::uint16_t>();
      channels[id] = {schema, std::string(cursor.Text())};
      Require(cursor.Text() == "cdr", "encoding of messages");
    }
    if (kind == 5) {
      const Channel& channel = channels.at(cursor.Take<std::uint16_t>());
      cursor.Take<std::uint32_t>();
      const auto time_ns = cursor.Take<std::uint64_t>();
      Require(cursor.Take<std::uint64_t>() == time_ns, "publish time");
      decoded.messages.push_back({channel.topic, schema_names.at(channel.schema), time_ns,
                                  schemas.at(channel.schema).Decode(cursor.Rest())});
    }
    if (kind == 6) {
      cursor.Bytes(16);
      inflated.resize(cursor.Take<std::uint64_t>());
      const auto crc = cursor.Take<std::uint32_t>();
      Require(cursor.Text() == "zstd", "compression");
      const std::string_view packed = cursor.Bytes(cursor.Take<std::uint64_t>());
      Require(cursor.is_at_end(), "bytes behind a chunk");
      const std::size_t size =
          ZSTD_decompress(inflated.data(), inflated.size(), packed.data(), packed.size());
      Require(size == inflated.size() && CrcOf(inflated) == crc, "chunk");
      Cursor records(inflated);
      while (!records.is_at_end()) {
        const char inner = records.Take<char>();
        self(self, inner, records.Bytes(records.Take<std::uint64_t>()));
      }
    }
    if (kind == 7) {
      const auto channel = cursor.Take<std::uint16_t>();
      Cursor entries(cursor.Text());
      while (!entries.is_at_end()) {
        const auto time_ns = entries.Take<std::uint64_t>();
        Cursor message(std::string_view(inflated).substr(entries.Take<std::uint64_t>()));
        Require(message.Take<char>() == 5, "index entry");
        message.Take<std::uint64_t>();
        Require(message.Take<std::uint16_t>() == channel, "channel of an index entry");
        message.Take<std::uint32_t>();
        Require(message.Take<std::uint64_t>() == time_ns, "time of an index entry");
        ++indexed;
      }
    }
    if (kind == 8) {
      cursor.Bytes(16);
      Require(kinds.at(cursor.Take<std::uint64_t>()) == 6, "chunk index");
      cursor.Take<std::uint64_t>();
      Cursor offsets(cursor.Text());
      while (!offsets.is_at_end()) {
        offsets.Take<std::uint16_t>();
        Require(kinds.at(offsets.Take<std::uint64_t>()) == 7, "offset of a message index");
      }
    }
    if (kind == 11) Require(cursor.Take<std::uint64_t>() == decoded.messages.size(), "count of messages");
    if (kind == 12) {
      cursor.Text();
      Cursor pairs(cursor.Text());
      while (!pairs.is_at_end()) {
        const std::string key(pairs.Text());
        decoded.metadata[key] = pairs.Text();
      }
    }
    if (kind == 13) Require(kinds.at(cursor.Take<std::uint64_t>()) == 12, "metadata index");
    if (kind == 14) {
      const char group = cursor.Take<char>();
      Require(kinds.at(cursor.Take<std::uint64_t>()) == group, "summary offset");
    }
    if (kind == 15) Require(cursor.Take<std::uint32_t>() == CrcOf(file.substr(0, at)), "CRC of the data");
    if (kind == 2) {
      const auto summary = cursor.Take<std::uint64_t>();
      Require(kinds.at(summary) == 3 && kinds.at(cursor.Take<std::uint64_t>()) == 14, "footer");
      const std::size_t end = at + 9 + 16;
      Require(cursor.Take<std::uint32_t>() == CrcOf(file.substr(summary, end - summary)),
              "CRC of the summary");
    }
  };
  while (at < file.size() - magic.size()) {
    Cursor head(std::string_view(file).substr(at));
    const char kind = head.Take<char>();
    const auto size = head.Take<std::uint64_t>();
    kinds[at] = kind;
    take_record(take_record, kind, head.Bytes(size));
    at += 9 + size;
  }
  Require(at == file.size() - magic.size(), "end of the file");
  Require(indexed == decoded.messages.size(), "messages without an index");
  return decoded;
}

}  // namespace sonarcal::testing
