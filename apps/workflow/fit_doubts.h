// Signs that a fit has not found what the recording shows: sentences for FitReport::warnings.
//
// The reference is the fitted model itself. Two of its speckled samples differ only by speckle and noise. A
// recording of the same scene from the same pose would agree with a sample equally well. The limits leave
// room for models that are only approximately right.
#pragma once

#include <string>
#include <vector>

#include "apps/workflow/fit.h"

namespace sonarcal::workflow {

// Returns one sentence per headline figure (IoU, intensity error) that the fit makes worse by more than 1 %
// of its value: figure, image, frames and both values. The error is that of the whole image if neither image
// has an object. Returns an empty list if nothing is worse.
std::vector<std::string> WorseFigures(const RecordingFit& fit);

// A fit is doubtful in these cases. Its IoU is below this share of the IoU between two samples.
inline constexpr double kMinShareOfOwnIou = 0.5;
// Its intensity error exceeds this multiple of the error between two samples.
inline constexpr double kMaxTimesOwnError = 2.0;
// The spread of its residuals exceeds this multiple of the spread that the noise law predicts.
inline constexpr double kMaxSpread = 2.0;
// A pose ends further from its prior than this number of prior standard deviations.
inline constexpr double kMaxPriorSigmas = 5.0;

// Returns one sentence per sign of doubt. `config` is that of the fit.
std::vector<std::string> DoubtsAbout(const RecordingFit& fit, const calib::FitConfig& config);

}  // namespace sonarcal::workflow
