// Frames of a comparison in its report: pictures of a few frames, which also print well, and a viewer of as
// many frames as fit into a page.
#pragma once

#include <cstddef>
#include <vector>

#include "apps/report/html/frame_viewer.h"
#include "apps/workflow/compare.h"
#include "apps/workflow/fit.h"

namespace sonarcal::report {

struct ShownFrames {
  std::vector<workflow::ComparedFrame> examples;
  FrameViewer viewer;
};

// Compares frames again, see workflow::CompareAgain. Keeps those of `examples`.
ShownFrames ShowFrames(const RecordingSource& real, const RecordingSource& simulated,
                       const workflow::CompareRecordingsOptions& options,
                       const metrics::MetricsReport& report, const std::vector<int>& examples);

// Frames after the fit, of those whose images the fit kept. The examples are those of `fit.frames_before`.
ShownFrames ShowFit(const workflow::RecordingFit& fit);

// Returns the frame with the middle intensity error.
const workflow::ComparedFrame& MiddleFrame(const std::vector<workflow::ComparedFrame>& frames,
                                           metrics::IntensityDomain domain);

}  // namespace sonarcal::report
