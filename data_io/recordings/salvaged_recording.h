// Readable part of a damaged recording: the frames that open, without those that do not.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/types/recording.h"

namespace sonarcal::data_io {

class SalvagedRecording final : public RecordingSource {
 public:
  // Reads every frame once to find the readable ones; calls `on_frame` after each. Adds notes with the
  // messages of the first ten unreadable frames, and their total number. Throws DataError if no frame is
  // readable.
  explicit SalvagedRecording(std::unique_ptr<RecordingSource> recording,
                             const std::function<void(int frames_done)>& on_frame = {});

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(readable_.size()); }
  FrameInfo frame_info(int index) const override { return recording_->frame_info(readable_.at(index)); }
  Frame ReadFrame(int index) const override { return recording_->ReadFrame(readable_.at(index)); }

  int lost_count() const { return recording_->frame_count() - frame_count(); }

 private:
  std::unique_ptr<RecordingSource> recording_;
  RecordingInfo info_;
  std::vector<int> readable_;
};

}  // namespace sonarcal::data_io
