// The parameters that a SIMULATED recording was made with, set beside what a fit of it found.
#pragma once

#include <optional>

#include "calib/fit_report.h"
#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "core/types/scene.h"

namespace sonarcal::workflow {

// Reads what stands in a recording's folder, `info.source`: `params.json`, which `simulate` and `reproduce`
// write into a synthetic recording, or a `truth.json` of another simulation with the keys gsab,
// noise_level_db, source_level_db, cell and reflection_pressure. Nothing where neither is there. Throws
// DataError for a file that cannot be read.
std::optional<ParameterSet> ReadTruth(const RecordingInfo& info);

// Enters the true values into the parameters and curves of `report`, a fit that found `fitted`. A value
// enters only where it means the same in both: nothing of the paper's model beside one of the other two, and
// no level where source level and gain (paper: source level and db_min) differ from the truth's.
void AddTruth(const ParameterSet& truth, const ParameterSet& fitted, const Scene& scene,
              const SonarModel& sonar, calib::FitReport& report);

}  // namespace sonarcal::workflow
