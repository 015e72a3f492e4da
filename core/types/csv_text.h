// Field of a CSV file, RFC 4180.
#pragma once

#include <string>

namespace sonarcal {

// Quotes the text if necessary.
inline std::string CsvText(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace sonarcal
