#include "data_io/recordings/selected_frames.h"

#include <utility>

#include "core/types/error.h"

namespace sonarcal::data_io {

SelectedFrames::SelectedFrames(std::unique_ptr<RecordingSource> recording, std::vector<int> frames)
    : recording_(std::move(recording)), frames_(std::move(frames)) {
  for (const int frame : frames_)
    SONARCAL_CHECK(frame >= 0 && frame < recording_->frame_count(), "frame {} of {}", frame,
                   recording_->frame_count());
}

std::unique_ptr<RecordingSource> SelectFrames(std::unique_ptr<RecordingSource> recording,
                                              const FrameList& frames) {
  if (frames.empty()) return recording;
  std::vector<int> selected = frames.In(recording->frame_count());
  return std::make_unique<SelectedFrames>(std::move(recording), std::move(selected));
}

}  // namespace sonarcal::data_io
