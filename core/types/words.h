// Enumerations and the words that name their values, on the command line, in JSON and in Python.
//
// The words stand once, beside the enumeration, in a function that is found by the enumeration's namespace:
//
//   enum class Sampling { kFrustum, kBeams };
//   constexpr auto WordsOf(std::type_identity<Sampling>) {
//     return Words<Sampling, 2>{{{"frustum", Sampling::kFrustum}, {"beams", Sampling::kBeams}}};
//   }
//
//   ToString(Sampling::kBeams)                  // "beams"
//   FromWord<Sampling>("frustum")               // Sampling::kFrustum
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace sonarcal {

template <typename E, std::size_t N>
using Words = std::array<std::pair<std::string_view, E>, N>;

template <typename E>
concept HasWords = std::is_enum_v<E> && requires {
  WordsOf(std::type_identity<E>{});
};

// Returns the word of `value`; empty for a value without a word.
template <typename E, std::size_t N>
constexpr std::string_view WordIn(const Words<E, N>& words, E value) {
  for (const auto& [word, meaning] : words) {
    if (meaning == value) return word;
  }
  return {};
}

template <HasWords E>
constexpr std::string_view ToString(E value) {
  return WordIn(WordsOf(std::type_identity<E>{}), value);
}

// Returns the value of `word`, or nothing if no value has this word.
template <HasWords E>
constexpr std::optional<E> FromWord(std::string_view word) {
  for (const auto& [known, meaning] : WordsOf(std::type_identity<E>{})) {
    if (known == word) return meaning;
  }
  return std::nullopt;
}

// Returns all words, such as "frustum|beams".
template <HasWords E>
std::string JoinedWords(std::string_view separator) {
  std::string joined;
  for (const auto& [word, meaning] : WordsOf(std::type_identity<E>{}))
    joined += (joined.empty() ? "" : std::string(separator)) + std::string(word);
  return joined;
}

}  // namespace sonarcal
