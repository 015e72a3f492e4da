// Realised false-alarm rates of the segmentation methods on the pings of a judged noise law
// (metrics/false_alarms.h).
#pragma once

#include <vector>

#include "apps/workflow/listener.h"
#include "calib/noise/noise_judgement.h"
#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "metrics/false_alarms.h"

namespace sonarcal::workflow {

// Rates at which the methods that state one are counted.
inline constexpr double kCountedRates[] = {0.1, 0.01, 0.001};

// Counts the pixels of the judged pings, window and cells. Settings are the defaults of compare, one pixel
// per cell and the looks of the law. Throws DataError if the parameters have no noise floor or do not fit the
// recording.
std::vector<metrics::FalseAlarmRate> MeasureFalseAlarms(const RecordingSource& recording,
                                                        const ParameterSet& parameters,
                                                        const calib::NoiseJudgement& judged,
                                                        const Listener& listener = {});

}  // namespace sonarcal::workflow
