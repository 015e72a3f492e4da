// What a fit is made from, for whoever wants to look at its model without fitting: the checks of a recording,
// and its frames as the models of calib/ take them.
#pragma once

#include <vector>

#include "apps/fit_recording.h"
#include "calib/models/acoustic_frame_model.h"
#include "calib/models/paper_frame_model.h"

namespace sonarcal {

// Throws DataError where the recording holds no grey levels, or the parameters' model cannot be fitted to it.
void CheckFittable(const RecordingSource& recording, const ParameterSet& initial,
                   const FitRecordingOptions& options);

// The echoes behind each pixel, by pose.
std::vector<EchoHistogram> TraceFrames(const Simulator& simulator, const std::vector<TimedPose>& poses,
                                       const FitRecordingOptions& options);

// The frames of these indices. `echoes` and `poses` are those of the whole recording.
std::vector<FitFrame> PaperFrames(const RecordingSource& recording, const std::vector<EchoHistogram>& echoes,
                                  const std::vector<int>& indices, const FitRecordingOptions& options);
std::vector<AcousticFrame> AcousticFrames(const RecordingSource& recording,
                                          const std::vector<TimedPose>& poses,
                                          const std::vector<int>& indices, const FitRecordingOptions& options,
                                          const DisplayParameters<double>& display);

// What the paper's model expects, 0..1 of full scale.
PolarImage PaperImage(const EchoHistogram& echoes, const ImageGeometry& geometry,
                      const PaperParameters<double>& parameters);

}  // namespace sonarcal
