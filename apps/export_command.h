// `sonarcal export --to WHAT --out FILE`: parameters and sonar as the configuration of another simulator, or
// a recording as a file of other tools.
#pragma once

#include <filesystem>
#include <string>

#include "apps/bag_options.h"
#include "apps/command.h"
#include "sim/physics/absorption.h"

namespace sonarcal {

enum class ExportTarget { kDave, kHoloOcean, kStonefish, kOceanSim, kGazebo, kRos1Bag, kNpz, kPng, kMp4 };

struct ExportOptions {
  CommonOptions common;
  ExportTarget to = ExportTarget::kDave;
  std::filesystem::path out;  // a file; for kPng a folder
  // Of a simulator's configuration:
  std::filesystem::path params;
  std::string sonar;  // a preset's name, a recording or a JSON file
  AbsorptionFormula absorption = AbsorptionFormula::kAuto;
  // Of a recording:
  std::filesystem::path recording;
  BagArguments bag;
  std::string frames;         // "A:B", see apps/frame_range.h; empty for all
  int height_px = 0;          // of pictures; 0: one a range bin, 800 at most
  double frames_per_s = 0.0;  // of a video; 0: as recorded
};

ExitStatus RunExport(const ExportOptions& options);

}  // namespace sonarcal
