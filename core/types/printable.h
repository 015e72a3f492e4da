// Makes text from a file safe for an error message.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace sonarcal {

// Returns at most `max_bytes` of `text` (then "..."), with control characters and bytes that are not UTF-8
// replaced by '?'. A malicious file can then neither flood the terminal nor send it commands.
std::string Printable(std::string_view text, std::size_t max_bytes = 80);

}  // namespace sonarcal
