// What a fit is made from, for whoever wants to look at its model without fitting: the checks of a recording,
// and its frames as the models of calib/ take them.
#pragma once

#include <vector>

#include "apps/workflow/fit.h"
#include "calib/models/acoustic_frame_model.h"
#include "calib/models/paper_frame_model.h"

namespace sonarcal::workflow {

// Throws DataError where the recording holds no grey levels, or the parameters' model cannot be fitted to it.
void CheckFittable(const RecordingSource& recording, const ParameterSet& initial,
                   const FitRecordingOptions& options);

// The echoes behind each pixel, by pose.
std::vector<sim::EchoHistogram> TraceFrames(const sim::Simulator& simulator,
                                            const std::vector<data_io::TimedPose>& poses,
                                            const FitRecordingOptions& options);

// The frames of these indices. `echoes` and `poses` are those of the whole recording.
std::vector<calib::FitFrame> PaperFrames(const RecordingSource& recording,
                                         const std::vector<sim::EchoHistogram>& echoes,
                                         const std::vector<int>& indices, const FitRecordingOptions& options);
std::vector<calib::AcousticFrame> AcousticFrames(const RecordingSource& recording,
                                                 const std::vector<data_io::TimedPose>& poses,
                                                 const std::vector<int>& indices,
                                                 const FitRecordingOptions& options,
                                                 const DisplayParameters<double>& display);

// What the paper's model expects, 0..1 of full scale.
PolarImage PaperImage(const sim::EchoHistogram& echoes, const sim::ImageGeometry& geometry,
                      const sim::PaperParameters<double>& parameters);

}  // namespace sonarcal::workflow
