// Signs that a fit has not found what the recording shows: sentences for FitReport::warnings.
//
// The yardstick is the fitted model itself. Two speckled samples of it differ by what speckle and noise do
// and by nothing else; a recording of the same scene from the same pose would agree with a sample as well.
// The limits leave room for models that are only nearly right.
//
// Metrics that a fit made worse, as sentences for FitReport::warnings.
#pragma once

#include <string>
#include <vector>

#include "apps/workflow/fit.h"

namespace sonarcal::workflow {

// One sentence for each headline figure (IoU, intensity error) that is worse after the fit than before it, by
// more than a hundredth of its value: figure, image, frames and both values. Where neither image has an
// object, the error is that of the whole image. Empty where nothing is worse.
std::vector<std::string> WorseFigures(const RecordingFit& fit);

// Doubtful: less than this share of the IoU that two samples reach, ...
inline constexpr double kMinShareOfOwnIou = 0.5;
// ... an intensity error of more than so many times that between two samples, ...
inline constexpr double kMaxTimesOwnError = 2.0;
// ... residuals that spread more than so many times as far as the noise law says, ...
inline constexpr double kMaxSpread = 2.0;
// ... and a pose so many standard deviations from what was known of it beforehand.
inline constexpr double kMaxPriorSigmas = 5.0;

// One sentence for each sign. `config` is that of the fit.
std::vector<std::string> DoubtsAbout(const RecordingFit& fit, const calib::FitConfig& config);

}  // namespace sonarcal::workflow
