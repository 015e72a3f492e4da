// Entry point of libFuzzer for the parser that SONARCAL_FUZZ_TARGET names.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const sonarcal::fuzz::Parser kParser = sonarcal::fuzz::FindParser(SONARCAL_FUZZ_TARGET);
  sonarcal::fuzz::Feed(kParser, {reinterpret_cast<const char*>(data), size});
  return 0;
}
