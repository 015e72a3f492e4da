// Suggestions for misspelt words: commands, options, names and words of a choice.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonarcal {

// Returns the number of letters to insert, remove, replace or exchange with their neighbour to turn `a` into
// `b`. Ignores case, and takes '-' and '_' as one letter.
int EditDistance(std::string_view a, std::string_view b);

// Returns the word with the smallest edit distance from `text`, the first of several. Returns nothing if
// more than one letter in three differs, or more than one of a text of one or two letters. A text of three
// or more letters is also near words that begin with it.
std::optional<std::string> NearestWord(std::string_view text, const std::vector<std::string>& words);

// Returns the end of a message about an unknown word, by what there is to say:
//
//   ", did you mean 'fit'?"
//   ", expected frustum|beams; did you mean 'beams'?"    // a short list
//   ", expected one of fit, compare, ..."                // no word is near
//
// `expected`: what to expect; empty: "one of " and the words.
std::string ExpectedWord(std::string_view text, const std::vector<std::string>& words,
                         std::string expected = {});

// Returns "'found', expected frustum|beams; did you mean 'beams'?". `expected`: words with '|' between them,
// of which `found` may hold several with commas between them; or any other text.
std::string UnknownWord(std::string_view found, const std::string& expected);

}  // namespace sonarcal
