// Checks of a recording before a fit, and its frames in the form that the models of calib/ take. Also for
// callers that inspect a model without a fit.
#pragma once

#include <optional>
#include <vector>

#include "apps/workflow/fit.h"
#include "calib/models/acoustic_frame_model.h"
#include "calib/paper/paper_frame_model.h"
#include "calib/selection/held_out_likelihood.h"

namespace sonarcal::workflow {

// Index of the first frame drawn as a sample of a fitted model. `simulate` numbers frames from 0, with the
// same default seed: a sample of the same index would share the speckle of a synthetic recording.
inline constexpr int kFirstSample = 1'000'000'000;

// Throws DataError if the recording holds no grey levels or if the model of `initial` cannot be fitted to it.
void CheckFittable(const RecordingSource& recording, const ParameterSet& initial,
                   const FitRecordingOptions& options);

// Returns the echoes behind each pixel, one histogram per pose; empty ones for poses that are not in
// `frames`.
std::vector<sim::EchoHistogram> TraceFrames(const sim::Simulator& simulator,
                                            const std::vector<data_io::TimedPose>& poses,
                                            const std::vector<int>& frames,
                                            const FitRecordingOptions& options);

// Return the frames with these indices. `echoes` and `poses` are those of the whole recording.
std::vector<calib::FitFrame> PaperFrames(const RecordingSource& recording,
                                         const std::vector<sim::EchoHistogram>& echoes,
                                         const std::vector<int>& indices, const FitRecordingOptions& options);
std::vector<calib::AcousticFrame> AcousticFrames(const RecordingSource& recording,
                                                 const std::vector<data_io::TimedPose>& poses,
                                                 const std::vector<int>& indices,
                                                 const FitRecordingOptions& options,
                                                 const DisplayParameters<double>& display);

// Returns the frames with these indices as recorded, for models of the acoustic kind. `poses` are those of
// the whole recording. `pixels`: those that may count; absent: all.
std::vector<calib::GreyFrame> GreyFrames(const RecordingSource& recording,
                                         const std::vector<data_io::TimedPose>& poses,
                                         const std::vector<int>& indices,
                                         const std::optional<Mask>& pixels = {});

// Expected image of the paper's model, 0..1 of full scale.
PolarImage PaperImage(const sim::EchoHistogram& echoes, const sim::ImageGeometry& geometry,
                      const sim::PaperParameters<double>& parameters);

}  // namespace sonarcal::workflow
