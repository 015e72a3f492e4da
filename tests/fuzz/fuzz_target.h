// Parsers fed with untrusted bytes. With clang and libFuzzer each parser becomes a program of its own, which
// looks for new inputs (scripts/fuzz.sh). With any compiler, one program replays the stored corpus and
// damaged copies of it (replay.cc); the tests run it for each parser.
//
// For every input a parser either reads it or throws DataError with a sentence. No other exception, no crash,
// no hang (10 s), and no allocation beyond kMaxFuzzMemoryMiB in total.
#pragma once

#include <string>
#include <string_view>

namespace sonarcal::fuzz {

// A picture may have 64 million pixels of four bytes (data_io/images/image_header.h), held twice while it is
// decoded; no parser may take more.
inline constexpr int kMaxFuzzMemoryMiB = 1024;

using Parser = void (*)(std::string_view bytes);

// Returns the parser called `name`, a folder of tests/fuzz/corpus, or nullptr.
Parser FindParser(std::string_view name);

// Feeds one input to a parser. Returns the sentence of its DataError, or an empty string if it read the
// input. Aborts on a DataError without a sentence, and lets every other exception pass.
std::string Feed(Parser parser, std::string_view bytes);

}  // namespace sonarcal::fuzz
