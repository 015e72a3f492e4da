// Conditions on the held-out frames of a fit.
#pragma once

#include "calib/parameters/fit_config.h"
#include "core/types/recording.h"

namespace sonarcal::calib {

// Throws DataError if a held-out frame and a used frame have identical pixels: the frame was given twice and
// evaluates nothing. Two pings of a sonar always differ by receiver noise. Frames of a single grey level,
// such as black ones, are not checked.
void CheckHeldOut(const RecordingSource& recording, const FrameSplit& split);

}  // namespace sonarcal::calib
