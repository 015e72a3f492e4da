// `sonarcal reproduce`: the paper's tank comparison, start to end, and the same on a real sonar's frames
// where the recordings are present.
#pragma once

#include <filesystem>

#include "apps/command.h"

namespace sonarcal {

struct ReproduceOptions {
  CommonOptions common;
  std::filesystem::path out;
  std::filesystem::path recordings;  // empty: $SONARCAL_RECORDINGS, else ./recordings
  bool text_sizes = false;           // the sizes of the paper's text instead of its Table 5
  std::uint64_t seed = 1;
  int threads = 0;
  bool quick = false;
};

ExitStatus RunReproduce(const ReproduceOptions& options);

}  // namespace sonarcal
