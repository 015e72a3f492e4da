// Recording whose frames get their poses from a trajectory, by their times.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/types/recording.h"
#include "data_io/trajectory_io.h"

namespace sonarcal::data_io {

struct PosesOverTime {
  std::vector<TrajectoryPose> world_from_body;
  Pose body_from_sonar = {};
  double time_offset_s = 0.0;  // added to a frame's time before the lookup
  double most_gap_s = 1.0;     // max time between two interpolated poses
};

// A frame outside the trajectory or in a gap of it has no pose, even if the recording contains one. A frame
// of several pings gets the motion from its first to its last ping. A motion that the recording contains is
// dropped.
class PosedRecording final : public RecordingSource {
 public:
  // Throws DataError if a frame has no time, or no frame has a pose.
  PosedRecording(std::unique_ptr<RecordingSource> recording, PosesOverTime poses);

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return recording_->frame_count(); }
  FrameInfo frame_info(int index) const override { return WithPose(index, recording_->frame_info(index)); }
  Frame ReadFrame(int index) const override {
    Frame frame = recording_->ReadFrame(index);
    frame.info = WithPose(index, std::move(frame.info));
    return frame;
  }

  int posed_count() const { return posed_count_; }

 private:
  FrameInfo WithPose(int index, FrameInfo info) const;

  std::unique_ptr<RecordingSource> recording_;
  PosesOverTime poses_;
  RecordingInfo info_;
  int posed_count_ = 0;
};

}  // namespace sonarcal::data_io
