// Numbers in texts.
#pragma once

#include <charconv>
#include <string_view>
#include <system_error>

namespace sonarcal {

// Reads the whole of `text` as a number. Returns false if it is not one or does not fit into T. Locales do
// not matter. A leading '+' is refused; NaN and infinities are numbers if T has them.
template <typename T>
bool ParseNumber(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace sonarcal
