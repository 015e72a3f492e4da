// `sonarcal recordings`: public recordings of real sonars, their licences, and which of them are here.
#pragma once

#include <filesystem>

#include "apps/command.h"

namespace sonarcal {

struct RecordingsOptions {
  CommonOptions common;
  std::filesystem::path folder;  // empty: DefaultRecordingsFolder()
};

ExitStatus RunRecordings(const RecordingsOptions& options);

}  // namespace sonarcal
