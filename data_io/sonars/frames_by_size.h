// Frames of one size that follow a file's header. They are counted by the file's size, because the count in a
// header is often wrong.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sonarcal::data_io {

struct FramesBySize {
  int count = 0;                 // whole frames
  std::uint64_t rest_bytes = 0;  // after the last whole frame
};

// frame_bytes > 0. A file shorter than its header has no frame and no rest. Throws DataError, naming the
// file, if the number of frames exceeds an int.
FramesBySize CountFramesBySize(const std::string& file, std::uint64_t file_bytes, std::uint64_t header_bytes,
                               std::uint64_t frame_bytes);

// Adds a note if the header's count differs, and one if the last frame is truncated.
void NoteFrameCount(const FramesBySize& frames, std::int64_t header_says, std::vector<std::string>& notes);

}  // namespace sonarcal::data_io
