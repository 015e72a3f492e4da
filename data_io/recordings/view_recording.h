// Recording for `sonarcal view`: with poses that were given or changed.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// Recording with other poses. A frame without an entry here has no pose.
class ReposedRecording final : public RecordingSource {
 public:
  // One entry per frame.
  ReposedRecording(std::shared_ptr<const RecordingSource> recording, std::vector<std::optional<Pose>> poses)
      : recording_(std::move(recording)), poses_(std::move(poses)) {}

  const RecordingInfo& info() const override { return recording_->info(); }
  int frame_count() const override { return recording_->frame_count(); }
  FrameInfo frame_info(int index) const override {
    FrameInfo info = recording_->frame_info(index);
    info.world_from_sonar = poses_.at(static_cast<std::size_t>(index));
    return info;
  }
  Frame ReadFrame(int index) const override {
    Frame frame = recording_->ReadFrame(index);
    frame.info.world_from_sonar = poses_.at(static_cast<std::size_t>(index));
    return frame;
  }

 private:
  std::shared_ptr<const RecordingSource> recording_;
  std::vector<std::optional<Pose>> poses_;
};

}  // namespace sonarcal::data_io
