#include "data_io/files/yaml_reader.h"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <sstream>
#include <unordered_set>

#include <pugixml.hpp>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/files/file_bytes.h"

namespace sonarcal::data_io {

struct YamlReader::Node {
  YAML::Node yaml;
};

namespace {

constexpr int kDeepestXml = 32;

// Elements become keys, "_" elements the items of a list; text of several words becomes a list of them.
YAML::Node OfXml(const pugi::xml_node& element, const std::string& file, int depth) {
  if (depth > kDeepestXml) throw DataError("{}: XML within XML more than {} deep", file, kDeepestXml);
  YAML::Node node;
  for (const pugi::xml_node& child : element.children()) {
    if (child.type() != pugi::node_element) continue;
    const std::string name = child.name();
    if (name == "_") {
      node.push_back(OfXml(child, file, depth + 1));
    } else {
      node.force_insert(name, OfXml(child, file, depth + 1));
    }
  }
  if (!node.IsNull()) return node;
  std::istringstream text(element.text().get());
  std::vector<std::string> words;
  for (std::string word; text >> word;) words.push_back(word);
  return words.size() == 1 ? YAML::Node(words.front()) : YAML::Node(words);
}

YAML::Node XmlNode(const std::string& text, const std::string& file) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size());
  if (!result) throw DataError("{}: not XML at byte {}: {}", file, result.offset, result.description());
  const pugi::xml_node root = document.child("opencv_storage");
  if (!root) throw DataError("{}: XML without 'opencv_storage', expected a file of OpenCV's", file);
  return OfXml(root, file, 0);
}

}  // namespace

YamlReader::YamlReader(std::unique_ptr<Node> node, std::string file, std::string path)
    : node_(std::move(node)), file_(std::move(file)), path_(std::move(path)) {}

YamlReader::~YamlReader() = default;

YamlReader::YamlReader(const YamlReader& other)
    : node_(std::make_unique<Node>(*other.node_)), file_(other.file_), path_(other.path_) {}

YamlReader& YamlReader::operator=(const YamlReader& other) {
  if (this == &other) return *this;
  node_ = std::make_unique<Node>(*other.node_);
  file_ = other.file_;
  path_ = other.path_;
  return *this;
}

YamlReader YamlReader::FromFile(const std::filesystem::path& file) {
  return FromText(ReadFileBytes(file, kMaxYamlBytes), file.string());
}

YamlReader YamlReader::FromText(std::string_view text, const std::string& file) {
  std::string yaml(text);
  if (yaml.starts_with("%YAML:")) yaml.front() = '#';
  const std::size_t first = yaml.find_first_not_of(" \t\r\n");
  try {
    if (first != std::string::npos && yaml[first] == '<')
      return {std::make_unique<Node>(Node{XmlNode(yaml, file)}), file, ""};
    return {std::make_unique<Node>(Node{YAML::Load(yaml)}), file, ""};
  } catch (const YAML::Exception& error) {
    throw DataError("{}:{}: not YAML: {}", file, error.mark.line + 1, Printable(error.msg));
  }
}

std::string YamlReader::place() const {
  const YAML::Mark mark = node_->yaml.Mark();
  return mark.is_null() ? file_ : fmt::format("{}:{}", file_, mark.line + 1);
}

void YamlReader::Fail(std::string_view what) const {
  throw DataError("{}: {} {}", place(), path_, what);
}

std::vector<std::pair<std::string, YamlReader>> YamlReader::Members() const {
  std::vector<std::pair<std::string, YamlReader>> members;
  if (!node_->yaml.IsMap()) return members;
  std::unordered_set<std::string> keys;
  for (const auto& member : node_->yaml) {
    if (!member.first.IsScalar()) continue;
    const std::string& key = member.first.Scalar();
    if (!keys.insert(key).second) {
      const YamlReader again(std::make_unique<Node>(Node{member.first}), file_, path_);
      throw DataError("{}: key '{}' for the second time", again.place(), Printable(key));
    }
    members.emplace_back(key, YamlReader(std::make_unique<Node>(Node{member.second}), file_,
                                         path_.empty() ? key : path_ + "." + key));
  }
  return members;
}

std::optional<YamlReader> YamlReader::Find(const std::string& key) const {
  for (auto& [name, member] : Members()) {
    if (name == key) return std::move(member);
  }
  return std::nullopt;
}

YamlReader YamlReader::At(const std::string& key) const {
  if (auto member = Find(key)) return *std::move(member);
  throw DataError("{}: no '{}'", place(), path_.empty() ? key : path_ + "." + key);
}

std::vector<YamlReader> YamlReader::Items() const {
  std::vector<YamlReader> items;
  if (!node_->yaml.IsSequence()) return items;
  for (const YAML::Node& item : node_->yaml)
    items.push_back(YamlReader(std::make_unique<Node>(Node{item}), file_, path_));
  return items;
}

std::string YamlReader::String() const {
  if (!node_->yaml.IsScalar()) Fail("is no text");
  return node_->yaml.Scalar();
}

double YamlReader::Number() const {
  double number = 0.0;
  const bool is_number = node_->yaml.IsScalar() && YAML::convert<double>::decode(node_->yaml, number);
  if (!is_number || !std::isfinite(number)) {
    Fail(fmt::format("is '{}', expected a finite number",
                     node_->yaml.IsScalar() ? Printable(node_->yaml.Scalar()) : std::string("no number")));
  }
  return number;
}

std::vector<double> YamlReader::Numbers() const {
  if (!node_->yaml.IsSequence()) Fail("is not a list, expected numbers in [ ]");
  std::vector<double> numbers;
  for (const YamlReader& item : Items()) numbers.push_back(item.Number());
  return numbers;
}

}  // namespace sonarcal::data_io
