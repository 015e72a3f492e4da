#include "data_io/posed_recording.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::data_io {

PosedRecording::PosedRecording(std::unique_ptr<RecordingSource> recording, PosesOverTime poses)
    : recording_(std::move(recording)), poses_(std::move(poses)), info_(recording_->info()) {
  int still_count = 0;  // frames with a pose and without a motion
  double first_s = std::numeric_limits<double>::infinity();
  double last_s = -first_s;
  for (int index = 0; index < frame_count(); ++index) {
    const FrameInfo frame = frame_info(index);
    first_s = std::min(first_s, *frame.time_s);
    last_s = std::max(last_s, *frame.time_s);
    if (frame.world_from_sonar) ++posed_count_;
    if (frame.world_from_sonar && !frame.motion) ++still_count;
  }
  if (posed_count_ == 0) {
    throw DataError(
        "{}: no frame has a pose: they were taken from {:.3f} to {:.3f} s (with an offset of {:g} s), the "
        "trajectory goes from {:.3f} to {:.3f} s; poses more than {:g} s apart are not joined",
        info_.source, first_s, last_s, poses_.time_offset_s, poses_.world_from_body.front().time_s,
        poses_.world_from_body.back().time_s, poses_.most_gap_s);
  }
  if (posed_count_ < frame_count()) {
    info_.notes.push_back(fmt::format(
        "{} of {} frames lie outside the trajectory, or in a gap of more than {:g} s, and have no pose.",
        frame_count() - posed_count_, frame_count(), poses_.most_gap_s));
  }
  if (info_.sonar.pings.is_timed() && still_count > 0) {
    info_.notes.push_back(
        fmt::format("{} of {} frames have a pose, but no motion: at their pings the trajectory has a gap, or "
                    "is faster than {:g} m/s or {:g} degrees/s.",
                    still_count, frame_count(), kMaxSpeedMPerS, kMaxTurnRateDegPerS));
  }
}

FrameInfo PosedRecording::WithPose(int index, FrameInfo info) const {
  if (!info.time_s) {
    throw DataError("{}: frame {} ({}) has no time, expected one to look its pose up by", info_.source, index,
                    info.name);
  }
  const auto pose_after = [&](double time_s) -> std::optional<Pose> {
    const auto world_from_body =
        PoseAt(poses_.world_from_body, *info.time_s + time_s + poses_.time_offset_s, poses_.most_gap_s);
    if (!world_from_body) return std::nullopt;
    return *world_from_body * poses_.body_from_sonar;
  };
  info.world_from_sonar = pose_after(0.0);
  info.motion.reset();  // that of the old poses
  const PingPattern& pings = info_.sonar.pings;
  if (!info.world_from_sonar || !pings.is_timed()) return info;
  const double first_s = pings.TimeOf(0);
  const double last_s = pings.TimeOf(pings.count() - 1);
  const std::optional<Pose> first = pose_after(first_s);
  const std::optional<Pose> last = pose_after(last_s);
  if (!first || !last) return info;
  const Motion motion = MotionBetween(*first, *last, *info.world_from_sonar, last_s - first_s);
  if (IsPlausible(motion)) info.motion = motion;
  return info;
}

}  // namespace sonarcal::data_io
