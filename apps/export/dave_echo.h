// Common parts of both versions of DAVE's multibeam sonar (dave_config.cc, dave_ros2_config.cc).
#pragma once

#include <string>

#include "apps/export/export_account.h"

namespace sonarcal::exporting {

inline constexpr int kDaveRaySkips = 1;  // uses every row of rays; the plugins' default is 10

// Accounts for looks, pulse and absorption, and for all parameters that are left. `bandwidth`: element of the
// bandwidth.
void AccountForDaveEcho(const ExportSource& source, const std::string& bandwidth, ExportAccount& account);

}  // namespace sonarcal::exporting
