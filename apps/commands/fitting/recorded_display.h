// Parameters of the fits that need no scene.
#pragma once

#include "apps/commands/fitting/fit_command.h"
#include "core/types/parameters.h"
#include "core/types/recording.h"

namespace sonarcal::commands {

// Returns those of --params, or the defaults of the acoustic model, with the display that the recording
// states. Prints a note if that changes the display. Throws DataError if neither gives a display.
ParameterSet ParametersWithDisplay(const FitCommandOptions& options, const RecordingInfo& info);

}  // namespace sonarcal::commands
