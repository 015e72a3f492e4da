// Recording with another description of its sonar, such as the calibrated one. A description without pings
// leaves those of the recording.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "core/types/error.h"
#include "core/types/recording.h"

namespace sonarcal::data_io {

class RecalibratedRecording final : public RecordingSource {
 public:
  // Throws DataError if the sonar has another number of range bins or beams.
  RecalibratedRecording(std::shared_ptr<const RecordingSource> recording, SonarModel sonar)
      : recording_(std::move(recording)), info_(recording_->info()), recorded_axes_(info_.sonar.axes) {
    const PolarAxes& recorded = info_.sonar.axes;
    if (sonar.axes.range_bins != recorded.range_bins || sonar.axes.beam_count() != recorded.beam_count()) {
      throw DataError("{}: {} range bins and {} beams, but the sonar '{}' has {} and {}", info_.source,
                      recorded.range_bins, recorded.beam_count(), sonar.name, sonar.axes.range_bins,
                      sonar.axes.beam_count());
    }
    if (sonar.pings.of_beam.empty()) sonar.pings = info_.sonar.pings;
    info_.sonar = std::move(sonar);
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return recording_->frame_count(); }
  FrameInfo frame_info(int index) const override { return recording_->frame_info(index); }
  // Throws DataError if the recorded axes of the frame differ from those of the first.
  Frame ReadFrame(int index) const override {
    Frame frame = recording_->ReadFrame(index);
    std::string why;
    if (!recorded_axes_.Matches(frame.image.axes, &why)) {
      throw DataError("{}: frame {} differs from the first: {}; a description of a sonar holds one geometry",
                      info_.source, index, why);
    }
    frame.image.axes = info_.sonar.axes;
    return frame;
  }

 private:
  std::shared_ptr<const RecordingSource> recording_;
  RecordingInfo info_;
  PolarAxes recorded_axes_;  // of the first frame
};

}  // namespace sonarcal::data_io
