// Recording that any number of threads may read. Readers of most formats are single-threaded.
#pragma once

#include <memory>
#include <mutex>
#include <utility>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// Lets one thread at a time read.
class LockedRecording final : public RecordingSource {
 public:
  explicit LockedRecording(std::unique_ptr<RecordingSource> recording) : recording_(std::move(recording)) {}

  const RecordingInfo& info() const override { return recording_->info(); }
  int frame_count() const override { return recording_->frame_count(); }
  FrameInfo frame_info(int index) const override {
    const std::scoped_lock lock(mutex_);
    return recording_->frame_info(index);
  }
  Frame ReadFrame(int index) const override {
    const std::scoped_lock lock(mutex_);
    return recording_->ReadFrame(index);
  }

 private:
  std::unique_ptr<RecordingSource> recording_;
  mutable std::mutex mutex_;
};

}  // namespace sonarcal::data_io
