#include "data_io/yaml_reader.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "data_io/file_bytes.h"
#include "data_io/printable.h"
#include "data_io/types/error.h"

namespace sonarcal {

struct YamlReader::Node {
  YAML::Node yaml;
};

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
  return FromText(ReadFileBytes(file, kMostYamlBytes), file.string());
}

YamlReader YamlReader::FromText(std::string_view text, const std::string& file) {
  std::string yaml(text);
  if (yaml.starts_with("%YAML:")) yaml.front() = '#';
  const std::size_t first = yaml.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && yaml[first] == '<') throw DataError("{}: XML, expected YAML", file);
  try {
    return {std::make_unique<Node>(Node{YAML::Load(yaml)}), file, ""};
  } catch (const YAML::Exception& error) {
    throw DataError("{}:{}: not YAML: {}", file, error.mark.line + 1, Printable(error.msg));
  }
}

int YamlReader::line() const {
  return node_->yaml.Mark().line + 1;
}

void YamlReader::Fail(std::string_view what) const {
  throw DataError("{}:{}: {} {}", file_, line(), path_, what);
}

std::vector<std::pair<std::string, YamlReader>> YamlReader::Members() const {
  std::vector<std::pair<std::string, YamlReader>> members;
  if (!node_->yaml.IsMap()) return members;
  for (const auto& member : node_->yaml) {
    if (!member.first.IsScalar()) continue;
    const std::string& key = member.first.Scalar();
    const bool is_new = std::ranges::none_of(members, [&](const auto& other) { return other.first == key; });
    if (!is_new) {
      throw DataError("{}:{}: key '{}' for the second time", file_, member.first.Mark().line + 1,
                      Printable(key));
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
  throw DataError("{}:{}: no '{}'", file_, line(), path_.empty() ? key : path_ + "." + key);
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
  if (!node_->yaml.IsSequence()) Fail("is no list, expected numbers in [ ]");
  std::vector<double> numbers;
  for (const YamlReader& item : Items()) numbers.push_back(item.Number());
  return numbers;
}

}  // namespace sonarcal
