// What frames must be to evaluate a fit that did not see them.
#pragma once

#include "calib/parameters/fit_config.h"
#include "core/types/recording.h"

namespace sonarcal {

// Throws DataError where the pixels of a held-out frame are those of a frame used, to the last one: it was
// given twice, and evaluates nothing. No two pings of a sonar are alike, because of receiver noise. Frames of
// one grey level throughout, such as black ones, do not count.
void CheckHeldOut(const RecordingSource& recording, const FrameSplit& split);

}  // namespace sonarcal
