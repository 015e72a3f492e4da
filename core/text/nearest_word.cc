#include "core/text/nearest_word.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "core/types/printable.h"

namespace sonarcal {
namespace {

constexpr std::size_t kShortList = 60;  // characters
constexpr std::size_t kLongestText = 100;

std::string Folded(std::string_view text) {
  std::string folded(text);
  for (char& c : folded) c = c == '_' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return folded;
}

std::vector<std::string> Split(std::string_view text, char at) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == at) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

}  // namespace

int EditDistance(std::string_view a, std::string_view b) {
  const std::string from = Folded(a);
  const std::string to = Folded(b);
  // Rows of the table of distances between the first i letters of `from` and the first j of `to`.
  std::vector<int> before_last;
  std::vector<int> last;
  std::vector<int> row(to.size() + 1);
  for (std::size_t j = 0; j <= to.size(); ++j) row[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= from.size(); ++i) {
    before_last = std::exchange(last, row);
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const int replaced = last[j - 1] + (from[i - 1] == to[j - 1] ? 0 : 1);
      row[j] = std::min({replaced, last[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[to.size()];
}

std::optional<std::string> NearestWord(std::string_view text, const std::vector<std::string>& words) {
  if (text.empty() || text.size() > kLongestText) return std::nullopt;
  std::optional<std::string> nearest;
  int smallest = std::max(1, static_cast<int>(text.size()) / 3) + 1;
  for (const std::string& word : words) {
    int distance = EditDistance(text, word);
    if (text.size() >= 3 && Folded(word).starts_with(Folded(text))) distance = std::min(distance, 1);
    if (distance >= smallest || distance >= static_cast<int>(word.size())) continue;
    smallest = distance;
    nearest = word;
  }
  return nearest;
}

std::string ExpectedWord(std::string_view text, const std::vector<std::string>& words, std::string expected) {
  if (expected.empty()) expected = fmt::format("one of {}", fmt::join(words, ", "));
  const std::optional<std::string> nearest = NearestWord(text, words);
  if (!nearest) return fmt::format(", expected {}", expected);
  if (expected.size() > kShortList) return fmt::format(", did you mean '{}'?", *nearest);
  return fmt::format(", expected {}; did you mean '{}'?", expected, *nearest);
}

std::string UnknownWord(std::string_view found, const std::string& expected) {
  // "frustum|beams", or "materials|noise, separated by commas" of which one item is wrong.
  std::vector<std::string> words;
  if (expected.find('|') != std::string::npos)
    words = Split(std::string_view(expected).substr(0, expected.find(',')), '|');
  std::string wrong(found);
  for (const std::string& item : Split(found, ',')) {
    if (std::ranges::find(words, item) != words.end()) continue;
    wrong = item;
    break;
  }
  return fmt::format("'{}'{}", Printable(found), ExpectedWord(wrong, words, expected));
}

}  // namespace sonarcal
