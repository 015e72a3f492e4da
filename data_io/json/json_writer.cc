#include "data_io/json/json_writer.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "data_io/files/atomic_output.h"

namespace sonarcal::data_io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLineWidth = 110;

// Visits every element of an array or object, with `separate` before each. Writes keys first, if there are
// any.
template <typename Separate, typename Write>
void ForEachElement(const Json& json, Separate separate, Write write) {
  bool first = true;
  for (const auto& [key, value] : json.items()) {
    separate(first);
    first = false;
    write(json.is_object() ? JsonLine(Json(key)) + ": " : std::string(), value);
  }
}

std::string InOneLine(const Json& json) {
  if (!json.is_structured()) return JsonLine(json);
  std::string text(1, json.is_object() ? '{' : '[');
  ForEachElement(
      json, [&](bool first) { text += first ? "" : ", "; },
      [&](const std::string& key, const Json& value) { text += key + InOneLine(value); });
  return text + (json.is_object() ? '}' : ']');
}

bool IsListOfScalars(const Json& json) {
  return json.is_array() &&
         std::none_of(json.begin(), json.end(), [](const Json& value) { return value.is_structured(); });
}

// `column` is the position of the value in its line.
void Append(const Json& json, int indent, std::size_t column, std::string& text) {
  std::string line = InOneLine(json);
  if (column + line.size() <= kLineWidth || IsListOfScalars(json) || !json.is_structured()) {
    text += line;
    return;
  }
  const auto begin_line = [&text](int margin) {
    text += '\n';
    text.append(static_cast<std::size_t>(margin), ' ');
  };
  text += json.is_object() ? '{' : '[';
  ForEachElement(
      json,
      [&](bool first) {
        if (!first) text += ',';
        begin_line(indent + 2);
      },
      [&](const std::string& key, const Json& value) {
        text += key;
        Append(value, indent + 2, static_cast<std::size_t>(indent) + 2 + key.size(), text);
      });
  begin_line(indent);
  text += json.is_object() ? '}' : ']';
}

}  // namespace

std::string JsonLine(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string JsonText(const Json& json) {
  std::string text;
  Append(json, 0, 0, text);
  return text + "\n";
}

void WriteJson(const std::filesystem::path& file, const Json& json) {
  WriteFileWhole(file, JsonText(json));
}

}  // namespace sonarcal::data_io
