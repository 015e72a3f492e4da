#include "data_io/recordings/frame_range.h"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/types/error.h"
#include "core/types/parse_number.h"
#include "core/types/printable.h"

namespace sonarcal::data_io {
namespace {

// Number of the range; `absent` if the text is empty.
int ParseBound(std::string_view text, int absent, const std::string& range) {
  if (text.empty()) return absent;
  int value = 0;
  if (!ParseNumber(text, value) || value < 0) {
    throw UsageError("frames '{}', expected A:B with whole numbers from 0", Printable(range));
  }
  return value;
}

}  // namespace

FrameRange ParseFrameRange(const std::string& text, int frame_count) {
  if (text.empty()) return {0, frame_count};
  const std::string_view view = text;
  const std::size_t colon = view.find(':');
  FrameRange range;
  range.begin = ParseBound(view.substr(0, colon), 0, text);
  if (colon == std::string_view::npos) {
    range.end = range.begin < frame_count ? range.begin + 1 : range.begin;
  } else {
    range.end = ParseBound(view.substr(colon + 1), frame_count, text);
  }
  if (range.end > frame_count || range.count() < 1) {
    throw DataError("frames '{}' of a recording with {} frames, expected at least one within 0:{}",
                    Printable(text), frame_count, frame_count);
  }
  return range;
}

std::vector<int> ParseFrameRanges(const std::string& text, int frame_count) {
  std::vector<int> frames;
  std::stringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const FrameRange range = ParseFrameRange(part, frame_count);
    for (int frame = range.begin; frame < range.end; ++frame) {
      if (std::ranges::find(frames, frame) != frames.end())
        throw UsageError("frames '{}' names frame {} twice", Printable(text), frame);
      frames.push_back(frame);
    }
  }
  return frames;
}

FrameRangeView::FrameRangeView(std::unique_ptr<RecordingSource> recording, FrameRange range)
    : recording_(std::move(recording)), range_(range) {
  SONARCAL_CHECK(range.begin >= 0 && range.count() >= 1 && range.end <= recording_->frame_count(),
                 "frames {}:{} of {}", range.begin, range.end, recording_->frame_count());
}

}  // namespace sonarcal::data_io
