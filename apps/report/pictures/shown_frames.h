// Frames of a comparison in its report: pictures of a few frames, which also print well, and a viewer of as
// many frames as fit into a page.
#pragma once

#include <cstddef>
#include <vector>

#include "apps/report/html/frame_viewer.h"
#include "apps/report/pictures/comparison_pictures.h"
#include "apps/workflow/compare.h"
#include "apps/workflow/fit.h"

namespace sonarcal::report {

struct ShownFrames {
  std::vector<FramePictures> pictures;  // example frames
  FrameViewer viewer;
};

// Compares frames again, see workflow::CompareAgain. Frames of `examples` get pictures.
ShownFrames ShowFrames(const RecordingSource& real, const RecordingSource& simulated,
                       const workflow::CompareRecordingsOptions& options,
                       const metrics::MetricsReport& report, const std::vector<int>& examples);

struct FitPictures {
  std::vector<FramePictures> before;  // same frames as `after`
  std::vector<FramePictures> after;
  FrameViewer viewer;  // after the fit
};

// Pictures of the frames whose images the fit kept.
FitPictures ShowFit(const workflow::RecordingFit& fit);

}  // namespace sonarcal::report
