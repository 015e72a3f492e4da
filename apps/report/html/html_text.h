// Text and bytes for HTML. The output is also well-formed XML, so that any tool can read it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sonarcal::report {

// The minus sign U+2212.
inline constexpr std::string_view kMinus = "\xE2\x88\x92";

// Escapes text for element content and quoted attributes. Bytes that are not UTF-8, and control characters,
// become U+FFFD.
std::string EscapeHtml(std::string_view text);

// Returns an anchor name: lower-case letters, digits and dashes of the text, never empty.
std::string Slug(std::string_view text);

std::string Base64(std::span<const std::uint8_t> bytes);

// Formats a number for a table or an axis: fixed decimals, a true minus sign, a dash if it is not finite.
std::string FormatNumber(double value, int decimals);
// A dash also if there is no value.
std::string FormatNumber(const std::optional<double>& value, int decimals);

// Name of the real side of a comparison: "recorded", or "synthetic" if a simulation made it. As a word and as
// the caption of a picture.
std::string RealWord(bool is_synthetic);
std::string RealCaption(bool is_synthetic);

}  // namespace sonarcal::report
