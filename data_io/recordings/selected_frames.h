// Some frames of a recording as a recording.
#pragma once

#include <memory>
#include <vector>

#include "core/types/frame_list.h"
#include "core/types/recording.h"

namespace sonarcal::data_io {

class SelectedFrames final : public RecordingSource {
 public:
  // `frames` are frames of `recording`, which are numbered from 0 in this order.
  SelectedFrames(std::unique_ptr<RecordingSource> recording, std::vector<int> frames);

  const RecordingInfo& info() const override { return recording_->info(); }
  int frame_count() const override { return static_cast<int>(frames_.size()); }
  FrameInfo frame_info(int index) const override { return recording_->frame_info(FrameAt(index)); }
  Frame ReadFrame(int index) const override { return recording_->ReadFrame(FrameAt(index)); }

 private:
  int FrameAt(int index) const { return frames_.at(static_cast<std::size_t>(index)); }

  std::unique_ptr<RecordingSource> recording_;
  std::vector<int> frames_;
};

// Returns the frames of the list, or `recording` itself if the list is empty. Throws as FrameList::In.
std::unique_ptr<RecordingSource> SelectFrames(std::unique_ptr<RecordingSource> recording,
                                              const FrameList& frames);

}  // namespace sonarcal::data_io
