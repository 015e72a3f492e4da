// Words of a text, taken from its front.
#pragma once

#include <algorithm>
#include <string_view>

namespace sonarcal::data_io {

inline constexpr std::string_view kBlanks = " \t\r\n\f\v";

// Removes the next word from `rest` and returns it. Empty at the end of the text.
inline std::string_view TakeWord(std::string_view& rest) {
  rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
  const std::string_view word = rest.substr(0, rest.find_first_of(kBlanks));
  rest.remove_prefix(word.size());
  return word;
}

}  // namespace sonarcal::data_io
