// `sonarcal scenes`: something to simulate. The paper's tank and mock-up (sim/scenes.h) as glTF, parameters
// to start from, and poses for its three data sets.
#pragma once

#include <filesystem>

#include "apps/command.h"

namespace sonarcal {

struct ScenesOptions {
  CommonOptions common;
  std::filesystem::path out;
  bool text_sizes = false;  // those of the paper's text rather than of its Table 5
  bool surface = false;     // add the water's surface
};

ExitStatus RunScenes(const ScenesOptions& options);

}  // namespace sonarcal
