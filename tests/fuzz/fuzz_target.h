// Parsers on bytes that nobody vouches for. Each target is a program of its own: with clang and libFuzzer it
// makes up inputs by what the code does with them (scripts/fuzz.sh); with any compiler it replays the stored
// corpus and damaged copies of it (replay.cc), which the tests do.
//
// What must hold for every input: it is read, or DataError comes out with a sentence. No other exception, no
// crash, no hang (10 s), nothing allocated beyond kMostFuzzMemoryMiB in all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace sonarcal::fuzz {

// A picture may have 64 million pixels of four bytes (data_io/images/image_header.h), held twice while it is
// decoded; no parser may take more.
inline constexpr int kMostFuzzMemoryMiB = 1024;

// What was said of the last input; empty where it was read.
inline std::string last_refusal;

}  // namespace sonarcal::fuzz

// libFuzzer's entry; 0 always.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
