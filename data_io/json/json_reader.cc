#include "data_io/json/json_reader.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/json/json_document.h"

namespace sonarcal::data_io {

// Keys that were requested of one object.
struct JsonReader::Lookups {
  std::string path;
  std::set<std::string, std::less<>> asked;
  bool any_key = false;
};

struct JsonReader::Document {
  std::string file;
  JsonNode root;
  std::unordered_map<const JsonNode*, Lookups> lookups;
};

namespace {

const JsonMember* FindMember(const JsonNode::Object& members, std::string_view key) {
  const auto found =
      std::lower_bound(members.begin(), members.end(), key,
                       [](const JsonMember& member, std::string_view k) { return member.key < k; });
  return found != members.end() && found->key == key ? &*found : nullptr;
}

// Value as a double, if it is a number.
std::optional<double> AsNumber(const JsonNode& node) {
  if (const auto* integer = std::get_if<std::int64_t>(&node.value)) return static_cast<double>(*integer);
  if (const auto* real = std::get_if<double>(&node.value)) return *real;
  return std::nullopt;
}

std::string Describe(const JsonNode& node) {
  if (const auto number = AsNumber(node)) return fmt::format("{}", *number);
  if (const auto* text = std::get_if<std::string>(&node.value))
    return fmt::format("\"{}\"", Printable(*text));
  if (const auto* flag = std::get_if<bool>(&node.value)) return *flag ? "true" : "false";
  if (const auto* list = std::get_if<JsonNode::Array>(&node.value)) {
    return fmt::format("a list of {}", list->size());
  }
  return std::holds_alternative<JsonNode::Object>(node.value) ? "an object" : "null";
}

}  // namespace

std::string NumberRange::Describe() const {
  const char* above = min_excluded ? ">" : ">=";
  if (std::isfinite(min) && std::isfinite(max)) {
    return fmt::format("a number {} {} and <= {}", above, min, max);
  }
  if (std::isfinite(min)) return fmt::format("a number {} {}", above, min);
  if (std::isfinite(max)) return fmt::format("a number <= {}", max);
  return "a number";
}

JsonReader JsonReader::FromFile(const std::filesystem::path& file) {
  auto document = std::make_shared<Document>(Document{file.string(), LoadJson(file), {}});
  const JsonNode* root = &document->root;
  return {std::move(document), root, {}};
}

JsonReader JsonReader::FromText(std::string_view text, const std::string& file) {
  auto document = std::make_shared<Document>(Document{file, ParseJson(text, file), {}});
  const JsonNode* root = &document->root;
  return {std::move(document), root, {}};
}

const std::string& JsonReader::file() const {
  return document_->file;
}
int JsonReader::line() const {
  return node_->line;
}
bool JsonReader::is_object() const {
  return std::holds_alternative<JsonNode::Object>(node_->value);
}
bool JsonReader::is_array() const {
  return std::holds_alternative<JsonNode::Array>(node_->value);
}

JsonReader JsonReader::At(std::string_view key) const {
  if (auto found = Find(key)) return *std::move(found);
  throw DataError("{}:{}: required key '{}' is missing", file(), line(), PathOf(key));
}

std::optional<JsonReader> JsonReader::Find(std::string_view key) const {
  const auto& members = Get<JsonNode::Object>("an object");
  LookInto().asked.emplace(key);
  const JsonMember* member = FindMember(members, key);
  if (member == nullptr || std::holds_alternative<std::nullptr_t>(member->value.value)) return std::nullopt;
  return JsonReader(document_, &member->value, PathOf(key));
}

std::vector<std::pair<std::string, JsonReader>> JsonReader::Members(std::size_t at_most) const {
  const auto& members = Get<JsonNode::Object>("an object");
  if (members.size() > at_most)
    Fail(fmt::format("has {} members, expected at most {}", members.size(), at_most));
  std::vector<std::pair<std::string, JsonReader>> readers;
  for (const JsonMember& member : members) {
    readers.emplace_back(member.key, JsonReader(document_, &member.value, PathOf(member.key)));
  }
  LookInto().any_key = true;
  return readers;
}

std::vector<JsonReader> JsonReader::Items() const {
  std::vector<JsonReader> readers;
  for (const JsonNode& node : Get<JsonNode::Array>("a list")) {
    readers.push_back(JsonReader(document_, &node, fmt::format("{}[{}]", path_, readers.size())));
  }
  return readers;
}

std::vector<double> JsonReader::Numbers(const NumberRange& range) const {
  std::vector<double> numbers;
  for (const JsonNode& node : Get<JsonNode::Array>("a list of numbers")) {
    const auto number = AsNumber(node);
    if (!number || !range.Contains(*number)) {
      JsonReader(document_, &node, fmt::format("{}[{}]", path_, numbers.size())).Number(range);
    }
    numbers.push_back(*number);
  }
  return numbers;
}

double JsonReader::Number(const NumberRange& range) const {
  const auto number = AsNumber(*node_);
  if (!number || !range.Contains(*number)) Fail(fmt::format("is {}, expected {}", Found(), range.Describe()));
  return *number;
}

std::int64_t JsonReader::Integer(std::int64_t min, std::int64_t max) const {
  std::optional<std::int64_t> integer;
  if (const auto* exact = std::get_if<std::int64_t>(&node_->value)) integer = *exact;
  constexpr double kExactLimit =
      9007199254740992.0;  // 2^53: beyond it a double does not represent every integer
  if (const auto* real = std::get_if<double>(&node_->value);
      real != nullptr && std::abs(*real) <= kExactLimit && std::trunc(*real) == *real) {
    integer = static_cast<std::int64_t>(*real);
  }
  if (!integer || *integer < min || *integer > max) {
    Fail(fmt::format("is {}, expected an integer from {} to {}", Found(), min, max));
  }
  return *integer;
}

bool JsonReader::Bool() const {
  return Get<bool>("true or false");
}

const std::string& JsonReader::String() const {
  return Get<std::string>("text in quotes");
}

std::optional<double> JsonReader::FindNumber(std::string_view key, const NumberRange& range) const {
  const auto found = Find(key);
  return found ? std::optional(found->Number(range)) : std::nullopt;
}

void JsonReader::Update(std::string_view key, double& value, const NumberRange& range) const {
  value = FindNumber(key, range).value_or(value);
}

void JsonReader::Fail(std::string_view what) const {
  const std::string subject = path_.empty() ? "the document" : fmt::format("'{}'", path_);
  throw DataError("{}:{}: {} {}", file(), line(), subject, what);
}

std::vector<JsonReader::UnknownKey> JsonReader::UnknownKeys() const {
  std::vector<UnknownKey> unknown;
  for (const auto& [node, lookups] : document_->lookups) {
    if (lookups.any_key) continue;
    const std::string expected =
        lookups.asked.empty() ? "no key" : fmt::format("one of {}", fmt::join(lookups.asked, ", "));
    const JsonReader object(document_, node, lookups.path);
    for (const JsonMember& member : std::get<JsonNode::Object>(node->value)) {
      if (!lookups.asked.contains(member.key)) {
        unknown.push_back({member.line, object.PathOf(member.key), expected});
      }
    }
  }
  std::sort(unknown.begin(), unknown.end(), [](const UnknownKey& a, const UnknownKey& b) {
    return std::tie(a.line, a.path) < std::tie(b.line, b.path);
  });
  return unknown;
}

void JsonReader::Finish() const {
  const std::vector<UnknownKey> unknown = UnknownKeys();
  if (unknown.empty()) return;
  const UnknownKey& first = unknown.front();
  throw DataError("{}:{}: unknown key '{}'; expected {}", file(), first.line, first.path, first.expected);
}

template <typename T>
const T& JsonReader::Get(std::string_view expected) const {
  const T* value = std::get_if<T>(&node_->value);
  if (value == nullptr) Fail(fmt::format("is {}, expected {}", Found(), expected));
  return *value;
}

JsonReader::Lookups& JsonReader::LookInto() const {
  Lookups& lookups = document_->lookups[node_];
  lookups.path = path_;
  return lookups;
}

std::string JsonReader::PathOf(std::string_view key) const {
  const std::string name = Printable(key);
  return path_.empty() ? name : path_ + "." + name;
}

std::string JsonReader::Found() const {
  return Describe(*node_);
}

void JsonReader::FailWord(const std::vector<std::string_view>& expected) const {
  Fail(fmt::format("is {}, expected one of {}", Found(), fmt::join(expected, ", ")));
}

}  // namespace sonarcal::data_io
