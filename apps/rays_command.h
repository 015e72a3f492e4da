// `sonarcal rays`: how far an image is from that of very many rays, for a series of ray counts by either
// sampling (apps/ray_errors.h), as a table, JSON, and a report with a chart.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/ray_errors.h"
#include "apps/scene_option.h"

namespace sonarcal {

struct RaysOptions {
  CommonOptions common;
  std::filesystem::path scene;
  SceneFormat scene_format;
  std::string sonar;
  std::filesystem::path params;
  std::filesystem::path poses;
  std::filesystem::path out;         // empty: the table alone
  std::vector<std::string> counts;   // "WxH"; empty: DefaultGrids
  std::optional<Sampling> sampling;  // absent: both
  std::string dense = "1500x1200";   // times `denser`
  double denser = 64.0;
  RayWeight weight = RayWeight::kEven;
  std::optional<double> display_db;  // up to the brightest echo; absent: the parameters' display
  AbsorptionFormula absorption = AbsorptionFormula::kAuto;
  int threads = 0;
};

ExitStatus RunRays(const RaysOptions& options);

}  // namespace sonarcal
