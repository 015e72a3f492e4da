// JSON text as a tree in which every key and value has its line number. Read it with
// data_io/json/json_reader.h.
//
// Throws DataError ("file:line: what was found, what was expected") for text that is not JSON or not UTF-8,
// numbers beyond the range of a double, duplicate keys, and text that exceeds these limits, so no file can
// exhaust memory or stack:
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace sonarcal::data_io {

inline constexpr std::size_t kMaxJsonBytes = std::size_t{64} << 20;
inline constexpr std::size_t kMaxJsonDepth = 64;
inline constexpr std::size_t kMaxJsonValues = 4'000'000;

struct JsonMember;

struct JsonNode {
  using Array = std::vector<JsonNode>;
  using Object = std::vector<JsonMember>;  // sorted by key, each key once

  // Integers that fit are stored exactly; other numbers are finite doubles.
  std::variant<std::nullptr_t, bool, std::int64_t, double, std::string, Array, Object> value;
  int line = 0;  // starts at 1; for an array or object the line of its first character
};

struct JsonMember {
  std::string key;
  int line = 0;  // line of the key
  JsonNode value;
};

// Depth of nesting and number of values of a text, counted from brackets and commas. In text that is not
// JSON the counts may be wrong after the first error, which is where a parser stops.
struct JsonSize {
  std::size_t depth = 0;
  std::size_t values = 1;
};
JsonSize SizeOfJson(std::string_view text);

// Discarded (is_discarded()) if the text is not JSON, or nested so deeply that a copy of it could exhaust the
// stack. Members are sorted: nlohmann::ordered_json takes hours to read an object of a million members.
nlohmann::json ParseLeniently(std::string_view text);

// Throws DataError if something follows a NUL byte, where parsers end. NUL bytes at the end are padding.
void CheckNoTextBehindNul(std::string_view text, const std::string& file);

// `file` is the name used in error messages.
JsonNode ParseJson(std::string_view text, const std::string& file);

// Also throws DataError if the file cannot be read.
JsonNode LoadJson(const std::filesystem::path& file);

}  // namespace sonarcal::data_io
