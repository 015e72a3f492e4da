#include "data_io/frame_tree.h"

#include <charconv>
#include <cmath>
#include <string_view>

#include "data_io/file_bytes.h"
#include "data_io/printable.h"
#include "data_io/types/error.h"

namespace sonarcal {
namespace {

constexpr std::size_t kMostBytes = 16 << 20;

std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string Unquoted(std::string_view text) {
  const bool quoted = text.size() >= 2 && text.front() == text.back() && (text[0] == '"' || text[0] == '\'');
  return std::string(quoted ? text.substr(1, text.size() - 2) : text);
}

// A frame while its lines are read.
struct Entry {
  int line = 0;  // of its first key
  std::string frame;
  std::string parent;
  std::map<std::string, double> numbers;  // "translation.x", ...

  Pose ToPose(const std::string& file) const {
    const auto number = [&](const std::string& key) {
      const auto found = numbers.find(key);
      if (found == numbers.end())
        throw DataError("{}:{}: frame '{}' has no {}, expected one", file, line, Printable(frame), key);
      return found->second;
    };
    constexpr double kOffUnit = 1e-3;
    const Eigen::Quaterniond rotation(number("rotation.w"), number("rotation.x"), number("rotation.y"),
                                      number("rotation.z"));
    if (!(std::abs(rotation.norm() - 1.0) <= kOffUnit)) {
      throw DataError("{}:{}: frame '{}': a quaternion of length {:g}, expected 1", file, line,
                      Printable(frame), rotation.norm());
    }
    return {rotation.normalized(),
            {number("translation.x"), number("translation.y"), number("translation.z")}};
  }
};

}  // namespace

FrameTree::FrameTree(const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::string text = ReadFileBytes(file, kMostBytes);
  Entry entry;
  std::string part;  // "translation" or "rotation", under which x, y, z and w stand
  const auto finish = [&] {
    if (entry.line == 0) return;
    if (entry.frame.empty() || entry.parent.empty())
      throw DataError("{}:{}: expected a frame_id and a parent_frame_id", name, entry.line);
    if (!frames_.emplace(entry.frame, Frame{entry.parent, entry.ToPose(name)}).second)
      throw DataError("{}:{}: frame '{}' stands twice", name, entry.line, Printable(entry.frame));
    entry = {};
  };
  std::string_view rest = text;
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    line = Trimmed(line.substr(0, line.find('#')));
    if (line.starts_with("- ")) {
      finish();
      entry.line = number;
      line = Trimmed(line.substr(2));
    }
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) continue;
    const std::string key(Trimmed(line.substr(0, colon)));
    const std::string_view value = Trimmed(line.substr(colon + 1));
    if (key == "frame_id") {
      entry.frame = Unquoted(value);
    } else if (key == "parent_frame_id") {
      entry.parent = Unquoted(value);
    } else if (value.empty()) {
      part = key;
    } else if (key == "x" || key == "y" || key == "z" || key == "w") {
      double& number_read = entry.numbers[part + "." + key];
      const auto [last, error] = std::from_chars(value.data(), value.data() + value.size(), number_read);
      if (error != std::errc() || last != value.data() + value.size() || !std::isfinite(number_read)) {
        throw DataError("{}:{}: {}.{} is '{}', expected a finite number", name, number, Printable(part), key,
                        Printable(value));
      }
    }
  }
  finish();
}

std::optional<Pose> FrameTree::Find(const std::string& ancestor, const std::string& frame) const {
  Pose ancestor_from_frame;
  std::string at = frame;
  // More steps than frames lead in a circle.
  for (std::size_t step = 0; at != ancestor; ++step) {
    const auto found = frames_.find(at);
    if (found == frames_.end() || step > frames_.size()) return std::nullopt;
    ancestor_from_frame = found->second.parent_from_frame * ancestor_from_frame;
    at = found->second.parent;
  }
  return ancestor_from_frame;
}

}  // namespace sonarcal
