// Recording for `sonarcal view`: with poses that were given or changed.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// Recording with other poses. A frame without an entry here has no pose. It keeps its motion if none is
// given.
class ReposedRecording final : public RecordingSource {
 public:
  // One entry per frame; `motions` may also be empty.
  ReposedRecording(std::shared_ptr<const RecordingSource> recording, std::vector<std::optional<Pose>> poses,
                   std::vector<std::optional<Motion>> motions = {})
      : recording_(std::move(recording)), poses_(std::move(poses)), motions_(std::move(motions)) {}

  const RecordingInfo& info() const override { return recording_->info(); }
  int frame_count() const override { return recording_->frame_count(); }
  FrameInfo frame_info(int index) const override { return Reposed(index, recording_->frame_info(index)); }
  Frame ReadFrame(int index) const override {
    Frame frame = recording_->ReadFrame(index);
    frame.info = Reposed(index, std::move(frame.info));
    return frame;
  }

 private:
  FrameInfo Reposed(int index, FrameInfo info) const {
    const auto frame = static_cast<std::size_t>(index);
    info.world_from_sonar = poses_.at(frame);
    if (!motions_.empty() && motions_.at(frame)) info.motion = motions_[frame];
    return info;
  }

  std::shared_ptr<const RecordingSource> recording_;
  std::vector<std::optional<Pose>> poses_;
  std::vector<std::optional<Motion>> motions_;
};

}  // namespace sonarcal::data_io
