// The frames of a comparison that a report shows: pictures of the telling ones, for paper and for who reads
// no further, and a viewer of as many as a page holds.
#pragma once

#include <cstddef>
#include <vector>

#include "apps/compare_recordings.h"
#include "apps/comparison_pictures.h"
#include "apps/report/frame_viewer.h"

namespace sonarcal {

struct ShownFrames {
  std::vector<FramePictures> telling;
  FrameViewer viewer;
};

// Compares the frames in question again, since kept pictures of every frame would grow with the recording.
// `options` are those that `report` was made with; the viewer holds at most `most` frames, and those in
// `telling` always.
ShownFrames ShowFrames(const RecordingSource& real, const RecordingSource& simulated,
                       const CompareRecordingsOptions& options, const MetricsReport& report,
                       const std::vector<int>& telling, std::size_t most);

}  // namespace sonarcal
