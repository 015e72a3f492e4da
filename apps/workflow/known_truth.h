// True parameters of a simulated recording, reported beside the values that a fit of it found.
#pragma once

#include <optional>

#include "calib/fit_report.h"
#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "core/types/scene.h"

namespace sonarcal::workflow {

// Reads the truth from the folder of a recording, `info.source`. The file is `truth.json` of another
// simulation (keys gsab, noise_level_db, source_level_db, cell and reflection_pressure), or else the
// `params.json` that `simulate` and `reproduce` write into a synthetic recording. Returns nullopt if neither
// exists. Throws DataError for a file that cannot be read.
std::optional<ParameterSet> ReadTruth(const RecordingInfo& info);

// Enters the true values into the parameters and curves of `report`, whose fit found `fitted`. Skips values
// that do not mean the same in both: all values if only one of the two models is the paper's, and amplitudes
// and curves if the sum of source level and gain differs (paper: source level minus db_min).
void AddTruth(const ParameterSet& truth, const ParameterSet& fitted, const Scene& scene,
              const SonarModel& sonar, calib::FitReport& report);

}  // namespace sonarcal::workflow
