// Text form of the values of options (core/types/option.h), as on the command line.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/types/frame_list.h"
#include "core/types/option.h"
#include "core/types/parse_number.h"
#include "core/types/words.h"

namespace sonarcal {

// Parse converts all of `text` and returns false if it cannot. Format is its inverse. Type is the placeholder
// in help texts, kExpected the end of an error message. Specialised for each type of option.
template <typename T>
struct OptionText;

namespace internal {

// Placeholder of a number with this unit: "M", "DEG", "DB", "N".
inline std::string NumberType(const OptionInfo& info) {
  if (info.unit.empty()) return "N";
  std::string type = info.unit;
  std::ranges::transform(type, type.begin(), [](unsigned char letter) { return std::toupper(letter); });
  return type;
}

// Parses "A<separator>B".
template <typename T>
bool ParsePair(std::string_view text, char separator, T& first, T& second) {
  const std::size_t middle = text.find(separator);
  return middle != std::string_view::npos && ParseNumber(text.substr(0, middle), first) &&
         ParseNumber(text.substr(middle + 1), second);
}

}  // namespace internal

// End of a message about a number outside the limits, such as ", expected 0 to 1024"; empty without limits.
inline std::string LimitsText(const OptionInfo& info) {
  const bool has_min = std::isfinite(info.min);
  const bool has_max = std::isfinite(info.max);
  if (has_min && has_max) return fmt::format(", expected {:g} to {:g}", info.min, info.max);
  if (has_min) return fmt::format(", expected {:g} or more", info.min);
  return has_max ? fmt::format(", expected {:g} or less", info.max) : std::string();
}

// End of a message about a number that is not IsWithin.
inline std::string ExpectedNumberText(const OptionInfo& info) {
  const std::string limits = LimitsText(info);
  return limits.empty() ? ", expected a finite number" : limits;
}

template <typename T>
requires std::is_arithmetic_v<T>
struct OptionText<T> {
  static bool Parse(const std::string& text, T& value) { return ParseNumber(text, value); }
  static std::string Format(const T& value) { return fmt::format("{}", value); }
  static std::string Type(const OptionInfo& info) { return internal::NumberType(info); }
  static constexpr const char* kExpected = std::is_floating_point_v<T> ? "a number"
                                           : std::is_unsigned_v<T>     ? "a whole number from 0 on"
                                                                       : "a whole number";
};

template <HasWords E>
struct OptionText<E> {
  static bool Parse(const std::string& text, E& value) {
    const std::optional<E> found = FromWord<E>(text);
    if (found) value = *found;
    return found.has_value();
  }
  static std::string Format(const E& value) { return std::string(ToString(value)); }
  static std::string Type(const OptionInfo&) { return JoinedWords<E>("|"); }
  static inline const std::string kExpected = JoinedWords<E>("|");
};

template <>
struct OptionText<std::string> {
  static bool Parse(const std::string& text, std::string& value) {
    value = text;
    return true;
  }
  static std::string Format(const std::string& value) { return value; }
  static std::string Type(const OptionInfo&) { return "NAME"; }
  static constexpr const char* kExpected = "text";
};

template <typename T>
struct OptionText<GridSize<T>> {
  static bool Parse(const std::string& text, GridSize<T>& value) {
    return internal::ParsePair(text, 'x', value.rows, value.cols);
  }
  static std::string Format(const GridSize<T>& value) { return fmt::format("{}x{}", value.rows, value.cols); }
  static std::string Type(const OptionInfo&) { return "RxC"; }
  static constexpr const char* kExpected = "rows x columns, such as 7x3";
};

template <>
struct OptionText<RayGridSize> {
  static bool Parse(const std::string& text, RayGridSize& value) {
    return internal::ParsePair(text, 'x', value.cols, value.rows) && value.cols > 0 && value.rows > 0;
  }
  static std::string Format(const RayGridSize& value) { return fmt::format("{}x{}", value.cols, value.rows); }
  static std::string Type(const OptionInfo&) { return "WxH"; }
  static constexpr const char* kExpected = "WIDTHxHEIGHT such as 1500x1200";
};

template <>
struct OptionText<Interval> {
  static bool Parse(const std::string& text, Interval& value) {
    return internal::ParsePair(text, ':', value.low, value.high) && value.low < value.high;
  }
  static std::string Format(const Interval& value) { return fmt::format("{}:{}", value.low, value.high); }
  static std::string Type(const OptionInfo&) { return "A:B"; }
  static constexpr const char* kExpected = "A:B with two numbers, A below B";
};

template <typename T>
struct OptionText<std::optional<T>> {
  static bool Parse(const std::string& text, std::optional<T>& value) {
    return OptionText<T>::Parse(text, value.emplace());
  }
  static std::string Format(const std::optional<T>& value) {
    return value ? OptionText<T>::Format(*value) : std::string();
  }
  static std::string Type(const OptionInfo& info) { return OptionText<T>::Type(info); }
  static inline const std::string kExpected = OptionText<T>::kExpected;
};

template <>
struct OptionText<FrameList> {
  static bool Parse(const std::string& text, FrameList& value) {
    const std::optional<FrameList> list = FrameList::Parse(text);
    if (list) value = *list;
    return list.has_value();
  }
  static std::string Format(const FrameList& value) { return value.Text(); }
  static std::string Type(const OptionInfo&) { return "K|A:B,..."; }
  static constexpr const char* kExpected = kFrameListExpected;
};

// Items separated by commas.
template <typename T>
struct OptionText<std::vector<T>> {
  static bool Parse(const std::string& text, std::vector<T>& value) {
    value.clear();
    for (std::string_view rest = text;;) {
      const std::size_t comma = rest.find(',');
      if (!OptionText<T>::Parse(std::string(rest.substr(0, comma)), value.emplace_back())) return false;
      if (comma == std::string_view::npos) return true;
      rest.remove_prefix(comma + 1);
    }
  }
  static std::string Format(const std::vector<T>& value) {
    std::string text;
    for (const T& item : value) text += (text.empty() ? "" : ",") + OptionText<T>::Format(item);
    return text;
  }
  static std::string Type(const OptionInfo& info) {
    const std::string item = OptionText<T>::Type(info);
    return item.find('|') != std::string::npos ? item + ",..." : item + "," + item;
  }
  static inline const std::string kExpected = std::string(OptionText<T>::kExpected) + ", separated by commas";
};

}  // namespace sonarcal
