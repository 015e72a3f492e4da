// Cursor over a JSON document. Every error in the document becomes one sentence with file, line and key:
//
//   const JsonReader root = JsonReader::FromFile("params.json");
//   const double gain_db = root.At("receiver").At("gain_db").Number(NumberRange::Between(-200, 200));
//   if (const auto water = root.Find("water")) ...
//   root.Finish();  // "params.json:7: unknown key 'receiver.gian_db'; expected one of gain_db, looks"
//
// A reader records the keys that are requested. Finish() rejects every other key of the objects that were
// read, so no line of a configuration is silently ignored.
//
// Readers are cheap to copy and share their document, which lives as long as the last of them. Copies in
// several threads need a lock. All functions throw DataError. data_io/json/json_document.h lists what is
// rejected before a reader exists.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/types/words.h"

namespace sonarcal::data_io {

struct JsonNode;

// Permitted range of a number. Every number is finite.
struct NumberRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_excluded = false;

  static NumberRange AtLeast(double min) { return {.min = min}; }
  static NumberRange Above(double min) { return {.min = min, .min_excluded = true}; }
  static NumberRange Between(double min, double max) { return {.min = min, .max = max}; }
  static NumberRange AboveUpTo(double min, double max) { return {min, max, true}; }

  bool Contains(double value) const {
    return value <= max && (min_excluded ? value > min : value >= min);  // false for NaN
  }
  std::string Describe() const;  // "a number > 0 and <= 360"
};

class JsonReader {
 public:
  static JsonReader FromFile(const std::filesystem::path& file);
  static JsonReader FromText(std::string_view text, const std::string& file);

  const std::string& file() const;
  int line() const;
  const std::string& path() const { return path_; }  // "frames[3].file"; empty at the root
  bool is_object() const;
  bool is_array() const;

  // Objects. A key whose value is null counts as absent.
  JsonReader At(std::string_view key) const;  // required
  std::optional<JsonReader> Find(std::string_view key) const;
  // By name. Any key is accepted.
  std::vector<std::pair<std::string, JsonReader>> Members(
      std::size_t at_most = std::numeric_limits<std::size_t>::max()) const;

  // Arrays.
  std::vector<JsonReader> Items() const;
  std::vector<double> Numbers(const NumberRange& range = {}) const;

  double Number(const NumberRange& range = {}) const;
  std::int64_t Integer(std::int64_t min, std::int64_t max) const;  // 3.0 is an integer, 3.5 is not
  bool Bool() const;
  const std::string& String() const;

  // Value that the string names.
  template <HasWords E>
  E Word() const {
    return Word(WordsOf(std::type_identity<E>{}));
  }
  template <typename E, std::size_t N>
  E Word(const Words<E, N>& words) const {
    std::vector<std::string_view> expected;
    for (const auto& [word, meaning] : words) {
      if (String() == word) return meaning;
      expected.push_back(word);
    }
    FailWord(expected);
  }

  // Throws unless the member "format" is this word.
  void CheckFormat(std::string_view format) const { At("format").Word(Words<bool, 1>{{{format, true}}}); }

  // FindNumber: number of an optional key, or nothing. Update: sets `value` if the key is present.
  std::optional<double> FindNumber(std::string_view key, const NumberRange& range = {}) const;
  void Update(std::string_view key, double& value, const NumberRange& range = {}) const;

  // Throws "file:line: 'path' <what>", for checks of several values.
  [[noreturn]] void Fail(std::string_view what) const;

  struct UnknownKey {
    int line = 0;
    std::string path;
    std::string expected;  // "one of a, b", or "no key"
  };
  // Keys that were not requested, of all objects of the document that were read, by line.
  std::vector<UnknownKey> UnknownKeys() const;

  // Throws DataError for the first of UnknownKeys().
  void Finish() const;

 private:
  struct Document;
  struct Lookups;

  JsonReader(std::shared_ptr<Document> document, const JsonNode* node, std::string path)
      : document_(std::move(document)), node_(node), path_(std::move(path)) {}

  template <typename T>
  const T& Get(std::string_view expected) const;
  Lookups& LookInto() const;
  std::string PathOf(std::string_view key) const;
  std::string Found() const;
  [[noreturn]] void FailWord(const std::vector<std::string_view>& expected) const;

  std::shared_ptr<Document> document_;
  const JsonNode* node_;
  std::string path_;
};

}  // namespace sonarcal::data_io
