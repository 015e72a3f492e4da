// `sonarcal convert FILE --out REC`: any format that can be read, written as a recording folder.
#pragma once

#include <filesystem>
#include <string>

#include "apps/command.h"

namespace sonarcal {

struct ConvertOptions {
  CommonOptions common;
  std::filesystem::path file;
  std::filesystem::path out;
  std::string frames;  // "A:B", see apps/frame_range.h; empty for all
};

ExitStatus RunConvert(const ConvertOptions& options);

}  // namespace sonarcal
