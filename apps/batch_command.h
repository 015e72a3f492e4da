// `sonarcal batch PLAN --out DIR`: simulates, compares or fits over many recordings and parameter sets
// (docs/guide/batch.md).
#pragma once

#include <filesystem>
#include <string>

#include "apps/command.h"

namespace sonarcal {

struct BatchOptions {
  CommonOptions common;
  std::filesystem::path plan;
  std::filesystem::path out;
  int processes = 1;
  int threads = 0;
  bool dry_run = false;
  bool summary_only = false;
  std::string only;  // id of one job; empty: all
};

// `root` has the commands that jobs run.
ExitStatus RunBatch(const BatchOptions& options, const CLI::App& root);

}  // namespace sonarcal
