// `sonarcal sonars`: the sonars that --sonar knows by name (sim/scenes/sonar_presets.h), with their sources.
#pragma once

#include "apps/command.h"

namespace sonarcal {

struct SonarsOptions {
  CommonOptions common;
};

ExitStatus RunSonars(const SonarsOptions& options);

}  // namespace sonarcal
