#include "data_io/recordings/levelled_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "data_io/recordings/frame_storage.h"

namespace sonarcal::data_io {
namespace {

constexpr double kFullScale = 65535.0;

class LevelledRecording final : public RecordingSource {
 public:
  explicit LevelledRecording(std::unique_ptr<RecordingSource> recording)
      : recording_(std::move(recording)), info_(recording_->info()) {
    info_.notes.push_back(fmt::format("Grey values of 0 .. {:g} without levels are read as 0 .. {:g}.",
                                      info_.scale.full_scale, kFullScale));
    info_.scale.full_scale = kFullScale;
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return recording_->frame_count(); }
  FrameInfo frame_info(int index) const override { return recording_->frame_info(index); }
  Frame ReadFrame(int index) const override {
    Frame frame = recording_->ReadFrame(index);
    const auto factor = static_cast<float>(kFullScale / frame.image.scale.full_scale);
    constexpr auto kTop = static_cast<float>(kFullScale);
    for (float& value : frame.image.value.values()) value = std::min(value * factor, kTop);
    frame.image.scale.full_scale = kFullScale;
    return frame;
  }

 private:
  std::unique_ptr<RecordingSource> recording_;
  RecordingInfo info_;
};

}  // namespace

std::unique_ptr<RecordingSource> WithLevels(std::unique_ptr<RecordingSource> recording) {
  const ImageScale& scale = recording->info().scale;
  if (scale.quantity != Quantity::kGrey || MinBits(scale) < 32 || scale.full_scale > kFullScale)
    return recording;
  return std::make_unique<LevelledRecording>(std::move(recording));
}

}  // namespace sonarcal::data_io
