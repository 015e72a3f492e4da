#include "data_io/sonars/frames_by_size.h"

#include <limits>

#include "core/types/error.h"

namespace sonarcal::data_io {

FramesBySize CountFramesBySize(const std::string& file, std::uint64_t file_bytes, std::uint64_t header_bytes,
                               std::uint64_t frame_bytes) {
  constexpr auto kMax = static_cast<std::uint64_t>(std::numeric_limits<int>::max());
  const std::uint64_t bytes = file_bytes > header_bytes ? file_bytes - header_bytes : 0;
  const std::uint64_t frames = bytes / frame_bytes;
  if (frames > kMax) throw DataError("{}: {} frames, expected at most {}", file, frames, kMax);
  return {.count = static_cast<int>(frames), .rest_bytes = bytes % frame_bytes};
}

void NoteFrameCount(const FramesBySize& frames, std::int64_t header_says, std::vector<std::string>& notes) {
  if (header_says != frames.count) {
    notes.push_back(
        fmt::format("The file header gives {} frames; the file's size gives {}.", header_says, frames.count));
  }
  if (frames.rest_bytes > 0) {
    notes.push_back(
        fmt::format("The last {} bytes are not a whole frame and were omitted.", frames.rest_bytes));
  }
}

}  // namespace sonarcal::data_io
