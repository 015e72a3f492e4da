// Signs that a fit has not found what the recording shows: sentences for FitReport::warnings.
//
// The yardstick is the fitted model itself. Two speckled samples of it differ by what speckle and noise do
// and by nothing else; a recording of the same scene from the same pose would agree with a sample as well.
// The limits leave room for models that are only nearly right.
#pragma once

#include <string>
#include <vector>

#include "apps/fit_recording.h"

namespace sonarcal {

// Doubtful: less than this share of the IoU that two samples reach, ...
inline constexpr double kMinShareOfOwnIou = 0.5;
// ... an intensity error of more than so many times that between two samples, ...
inline constexpr double kMaxTimesOwnError = 2.0;
// ... residuals that spread more than so many times as far as the noise law says, ...
inline constexpr double kMaxSpread = 2.0;
// ... and a pose so many standard deviations from what was known of it beforehand.
inline constexpr double kMaxPriorSigmas = 5.0;

// One sentence for each sign. `config` is that of the fit.
std::vector<std::string> DoubtsAbout(const RecordingFit& fit, const FitConfig& config);

}  // namespace sonarcal
