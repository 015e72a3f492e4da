#include "core/types/printable.h"

#include <algorithm>

namespace sonarcal {
namespace {

bool IsContinuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

// True if the byte may follow the lead byte: excludes characters written with more bytes than they need,
// surrogates, and values above U+10FFFF (The Unicode Standard, table 3-7).
bool IsSecond(unsigned char lead, unsigned char second) {
  switch (lead) {
    case 0xE0:
      return second >= 0xA0;
    case 0xED:
      return second <= 0x9F;
    case 0xF0:
      return second >= 0x90;
    case 0xF4:
      return second <= 0x8F;
    default:
      return true;
  }
}

// Length in bytes of the UTF-8 character at the start of `text`, or 0 if there is none.
std::size_t CharacterLength(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  const std::size_t length = lead < 0x80   ? 1
                             : lead < 0xC2 ? 0
                             : lead < 0xE0 ? 2
                             : lead < 0xF0 ? 3
                             : lead < 0xF5 ? 4
                                           : 0;
  if (length == 0 || length > text.size()) return 0;
  if (length > 1 && !IsSecond(lead, static_cast<unsigned char>(text[1]))) return 0;
  const std::string_view tail = text.substr(1, length - 1);
  return std::all_of(tail.begin(), tail.end(), IsContinuation) ? length : 0;
}

// True for C0 and C1 controls and DEL, which a terminal may interpret as commands.
bool IsControl(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return first < 0x20 || first == 0x7F;
  return first == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0;
}

}  // namespace

std::string Printable(std::string_view text, std::size_t max_bytes) {
  std::string printable;
  while (!text.empty()) {
    const std::size_t length = CharacterLength(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
    const bool shown = length > 0 && !IsControl(character);
    if (printable.size() + (shown ? length : 1) > max_bytes) return printable + "...";
    printable += shown ? character : "?";
    text.remove_prefix(character.size());
  }
  return printable;
}

}  // namespace sonarcal
