// JSON text as a tree in which every key and value knows its line. Read it through
// data_io/json/json_reader.h.
//
// Throws DataError ("file:line: what was found, what was expected") for text that is not JSON or not UTF-8,
// numbers beyond the range of a double, a key given twice, and for what exceeds these limits, which keep any
// file from exhausting memory or stack:
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace sonarcal::data_io {

inline constexpr std::size_t kMaxJsonBytes = std::size_t{64} << 20;
inline constexpr std::size_t kMaxJsonDepth = 64;
inline constexpr std::size_t kMaxJsonValues = 2'000'000;

struct JsonMember;

struct JsonNode {
  using Array = std::vector<JsonNode>;
  using Object = std::vector<JsonMember>;  // sorted by key, each key once

  // Integers that fit are kept exactly; other numbers are finite doubles.
  std::variant<std::nullptr_t, bool, std::int64_t, double, std::string, Array, Object> value;
  int line = 0;  // from 1; of an array or object the line where it begins
};

struct JsonMember {
  std::string key;
  int line = 0;  // of the key
  JsonNode value;
};

// `file` is the name that error sentences carry.
JsonNode ParseJson(std::string_view text, const std::string& file);

// Also throws DataError where the file cannot be read.
JsonNode LoadJson(const std::filesystem::path& file);

}  // namespace sonarcal::data_io
