#include "data_io/json/json_document.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/files/file_bytes.h"

namespace sonarcal::data_io {
namespace {

// Iterates over the text and publishes the address of the last character read. The parser reads a number up
// to the character that ends it, and every other token up to its own last one. The newlines before the
// published address are therefore those before the token, although the parser reports no lines to its
// handlers.
class TrackingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  TrackingIterator(const char* position, const char** last_read)
      : position_(position), last_read_(last_read) {}

  reference operator*() const {
    *last_read_ = position_;
    return *position_;
  }
  TrackingIterator& operator++() {
    ++position_;
    return *this;
  }
  bool operator==(const TrackingIterator& other) const { return position_ == other.position_; }

 private:
  const char* position_;
  const char** last_read_;
};

// "[json.exception.parse_error.101] parse error at line 3, column 5: syntax error ..." -> "syntax error ..."
std::string SyntaxErrorText(std::string_view text) {
  if (const std::size_t tag = text.find("] "); text.starts_with('[') && tag != std::string_view::npos) {
    text.remove_prefix(tag + 2);
  }
  if (const std::size_t place = text.find(": ");
      text.starts_with("parse error at") && place != std::string_view::npos) {
    text.remove_prefix(place + 2);
  }
  return Printable(text, 200);
}

class TreeBuilder final : public nlohmann::json_sax<nlohmann::json> {
 public:
  TreeBuilder(std::string_view text, const std::string& file)
      : file_(file), text_(text), counted_to_(text.data()), last_read_(text.data()) {}

  JsonNode Build() {
    const TrackingIterator begin(text_.data(), &last_read_);
    const TrackingIterator end(text_.data() + text_.size(), &last_read_);
    nlohmann::json::sax_parse(begin, end, this);
    return std::move(root_);
  }

  bool null() override { return Add(nullptr); }
  bool boolean(bool value) override { return Add(value); }
  bool number_integer(number_integer_t value) override { return Add(value); }
  bool number_unsigned(number_unsigned_t value) override {
    if (value > static_cast<number_unsigned_t>(std::numeric_limits<std::int64_t>::max())) {
      return Add(static_cast<double>(value));
    }
    return Add(static_cast<std::int64_t>(value));
  }
  bool number_float(number_float_t value, const string_t&) override { return Add(value); }
  bool string(string_t& value) override { return Add(std::move(value)); }
  bool binary(binary_t&) override { return false; }  // does not occur in JSON text

  bool start_object(std::size_t) override { return Open(JsonNode::Object{}); }
  bool start_array(std::size_t) override { return Open(JsonNode::Array{}); }
  bool end_array() override { return Close(); }
  bool end_object() override {
    auto& members = std::get<JsonNode::Object>(open_.back()->value);
    std::stable_sort(members.begin(), members.end(), ByKey);
    const auto twice = std::adjacent_find(members.begin(), members.end(),
                                          [](const auto& a, const auto& b) { return a.key == b.key; });
    if (twice != members.end()) {
      throw DataError("{}:{}: key '{}' is given twice, first in line {}; expected it once", file_,
                      std::next(twice)->line, Printable(twice->key), twice->line);
    }
    return Close();
  }

  bool key(string_t& value) override {
    std::get<JsonNode::Object>(open_.back()->value).push_back({std::move(value), Line(), {}});
    return true;
  }

  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& error) override {
    throw DataError("{}:{}: not valid JSON: {}", file_, Line(), SyntaxErrorText(error.what()));
  }

 private:
  static bool ByKey(const JsonMember& a, const JsonMember& b) { return a.key < b.key; }

  // Counts only the characters read since the last call.
  int Line() {
    line_ += static_cast<int>(std::count(counted_to_, last_read_, '\n'));
    counted_to_ = last_read_;
    return line_;
  }

  template <typename T>
  bool Add(T&& value) {
    Place(JsonNode{std::forward<T>(value), Line()});
    return true;
  }

  template <typename T>
  bool Open(T container) {
    if (open_.size() >= kMaxJsonDepth) {
      throw DataError("{}:{}: nested {} levels deep, expected at most {}", file_, Line(), open_.size() + 1,
                      kMaxJsonDepth);
    }
    open_.push_back(&Place(JsonNode{std::move(container), Line()}));
    return true;
  }

  bool Close() {
    open_.pop_back();
    return true;
  }

  // Stores a value in the innermost open container. A container grows only while everything in it is closed,
  // so the addresses in open_ stay valid.
  JsonNode& Place(JsonNode node) {
    if (++value_count_ > kMaxJsonValues) {
      throw DataError("{}:{}: more than {} values, expected fewer", file_, Line(), kMaxJsonValues);
    }
    if (open_.empty()) return root_ = std::move(node);
    if (auto* array = std::get_if<JsonNode::Array>(&open_.back()->value)) {
      return array->emplace_back(std::move(node));
    }
    return std::get<JsonNode::Object>(open_.back()->value).back().value = std::move(node);
  }

  const std::string& file_;
  std::string_view text_;
  const char* counted_to_;
  const char* last_read_;
  int line_ = 1;
  std::size_t value_count_ = 0;
  JsonNode root_;
  std::vector<JsonNode*> open_;  // containers being filled, outermost first
};

}  // namespace

JsonSize SizeOfJson(std::string_view text) {
  JsonSize size;
  std::size_t depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      ++size.values;
      size.depth = std::max(size.depth, ++depth);
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    } else if (c == ',') {
      ++size.values;
    }
  }
  return size;
}

nlohmann::json ParseLeniently(std::string_view text) {
  if (SizeOfJson(text).depth > kMaxJsonDepth) return nlohmann::json(nlohmann::json::value_t::discarded);
  return nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
}

void CheckNoTextBehindNul(std::string_view text, const std::string& file) {
  const std::size_t nul = text.find('\0');
  if (text.find_first_not_of('\0', nul) == std::string_view::npos) return;
  throw DataError("{}: byte {} is NUL, expected text", file, nul);
}

JsonNode ParseJson(std::string_view text, const std::string& file) {
  if (text.size() > kMaxJsonBytes) {
    throw DataError("{}: {} bytes of JSON, expected at most {}", file, text.size(), kMaxJsonBytes);
  }
  CheckNoTextBehindNul(text, file);
  return TreeBuilder(text, file).Build();
}

JsonNode LoadJson(const std::filesystem::path& file) {
  return ParseJson(ReadFileBytes(file, kMaxJsonBytes), file.string());
}

}  // namespace sonarcal::data_io
