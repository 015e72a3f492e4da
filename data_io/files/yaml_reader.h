// Cursor over a YAML file, like JsonReader (data_io/json/json_reader.h) for JSON: every error is one sentence
// with file, line and key. In contrast to JsonReader, unknown keys are ignored, because the files come from
// other programs. Uses yaml-cpp. Ignores the directive "%YAML:1.0" of OpenCV's files, which is not valid
// YAML. Also reads the XML that OpenCV writes with the same keys, by pugixml.
//
// All functions throw DataError.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonarcal::data_io {

class YamlReader {
 public:
  // First document of a file of at most kMaxYamlBytes.
  static YamlReader FromFile(const std::filesystem::path& file);
  static YamlReader FromText(std::string_view text, const std::string& file);
  ~YamlReader();
  YamlReader(const YamlReader& other);
  YamlReader& operator=(const YamlReader& other);

  const std::string& file() const { return file_; }
  std::string place() const;                         // "file:line"; for XML only the file
  const std::string& path() const { return path_; }  // "camera_matrix.data"; empty at the root

  YamlReader At(const std::string& key) const;  // required
  std::optional<YamlReader> Find(const std::string& key) const;
  std::vector<std::pair<std::string, YamlReader>> Members() const;  // empty if it is not a map
  std::vector<YamlReader> Items() const;                            // empty if it is not a list

  std::string String() const;
  double Number() const;  // finite
  std::vector<double> Numbers() const;

  // Throws "file:line: path <what>".
  [[noreturn]] void Fail(std::string_view what) const;

 private:
  struct Node;
  YamlReader(std::unique_ptr<Node> node, std::string file, std::string path);

  std::unique_ptr<Node> node_;
  std::string file_;
  std::string path_;
};

inline constexpr std::size_t kMaxYamlBytes = std::size_t{1} << 20;

}  // namespace sonarcal::data_io
