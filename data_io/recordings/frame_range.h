// Range of frames, given on the command line as A:B, like a slice: from frame A up to, but not including, B.
// Either may be omitted; a single number is one frame.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/types/recording.h"

namespace sonarcal::data_io {

struct FrameRange {
  int begin = 0;
  int end = 0;  // one past the last

  int count() const { return end - begin; }
};

// Throws UsageError if `text` is not a range, and DataError if it names frames beyond `frame_count`.
FrameRange ParseFrameRange(const std::string& text, int frame_count);

// The frames of one range or of several separated by commas, "0:3,7:9", in this order. Throws as
// ParseFrameRange, and UsageError for a frame that is named twice.
std::vector<int> ParseFrameRanges(const std::string& text, int frame_count);

// Selected frames as a recording, numbered from 0.
class FrameRangeView final : public RecordingSource {
 public:
  FrameRangeView(std::unique_ptr<RecordingSource> recording, FrameRange range);

  const RecordingInfo& info() const override { return recording_->info(); }
  int frame_count() const override { return range_.count(); }
  FrameInfo frame_info(int index) const override { return recording_->frame_info(range_.begin + index); }
  Frame ReadFrame(int index) const override { return recording_->ReadFrame(range_.begin + index); }

 private:
  std::unique_ptr<RecordingSource> recording_;
  FrameRange range_;
};

}  // namespace sonarcal::data_io
