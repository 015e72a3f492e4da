// A cursor over a YAML file, as JsonReader (data_io/json/json_reader.h) is one over JSON: every mistake is
// one sentence with file, line and key. Unlike there, keys that nobody asks for are passed over: the files
// are other programs'. Read by yaml-cpp; the directive "%YAML:1.0" of OpenCV's files, which is no YAML, is
// passed over. The XML that OpenCV writes of the same keys is read as well, by pugixml.
//
// Everything throws DataError.
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
  // The first document of a file of at most kMostYamlBytes.
  static YamlReader FromFile(const std::filesystem::path& file);
  static YamlReader FromText(std::string_view text, const std::string& file);
  ~YamlReader();
  YamlReader(const YamlReader& other);
  YamlReader& operator=(const YamlReader& other);

  const std::string& file() const { return file_; }
  std::string place() const;                         // "file:line"; of XML the file alone
  const std::string& path() const { return path_; }  // "camera_matrix.data"; empty at the root

  YamlReader At(const std::string& key) const;  // required
  std::optional<YamlReader> Find(const std::string& key) const;
  std::vector<std::pair<std::string, YamlReader>> Members() const;  // none where it is no map
  std::vector<YamlReader> Items() const;                            // none where it is no list

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

inline constexpr std::size_t kMostYamlBytes = std::size_t{1} << 20;

}  // namespace sonarcal::data_io
