// What can be read of a damaged recording: the frames that open, without those that do not.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/types/recording.h"

namespace sonarcal::data_io {

class SalvagedRecording final : public RecordingSource {
 public:
  // Reads every frame once to see which can be read; `on_frame` follows each. The first ten of those that
  // cannot are noted with their sentence, and how many there are in all. Throws DataError where none can be
  // read.
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
