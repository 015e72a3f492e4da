#include "data_io/recordings/salvaged_recording.h"

#include <utility>

#include "core/types/error.h"

namespace sonarcal::data_io {

SalvagedRecording::SalvagedRecording(std::unique_ptr<RecordingSource> recording,
                                     const std::function<void(int frames_done)>& on_frame)
    : recording_(std::move(recording)), info_(recording_->info()) {
  constexpr int kMaxNotes = 10;
  const int count = recording_->frame_count();
  for (int index = 0; index < count; ++index) {
    try {
      recording_->frame_info(index);
      recording_->ReadFrame(index);
      readable_.push_back(index);
    } catch (const DataError& error) {
      const int lost = index + 1 - static_cast<int>(readable_.size());
      if (lost <= kMaxNotes)
        info_.notes.push_back(fmt::format("Frame {} was omitted: {}", index, error.what()));
    }
    if (on_frame) on_frame(index + 1);
  }
  if (readable_.empty()) throw DataError("{}: none of {} frames can be read", info_.source, count);
  if (lost_count() > 0)
    info_.notes.push_back(
        fmt::format("{} of {} frames could not be read and were omitted.", lost_count(), count));
}

}  // namespace sonarcal::data_io
