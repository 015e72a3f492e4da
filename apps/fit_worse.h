// Metrics that a fit made worse, as sentences for FitReport::warnings.
#pragma once

#include <string>
#include <vector>

#include "apps/fit_recording.h"

namespace sonarcal {

// One sentence for each headline figure (IoU, intensity error) that is worse after the fit than before it, by
// more than a hundredth of its value: figure, image, frames and both values. Where neither image has an
// object, the error is that of the whole image. Empty where nothing is worse.
std::vector<std::string> WorseFigures(const RecordingFit& fit);

}  // namespace sonarcal
