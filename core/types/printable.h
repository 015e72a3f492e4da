// Text from a file made fit for an error sentence.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace sonarcal {

// At most `max_bytes` of `text` (then "..."), with control characters and bytes that are not UTF-8 replaced
// by '?': a hostile file can neither flood the terminal nor send it commands.
std::string Printable(std::string_view text, std::size_t max_bytes = 80);

}  // namespace sonarcal
