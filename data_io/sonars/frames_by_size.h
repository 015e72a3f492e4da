// Frames of one size, one after the other behind a file's header: counted by the file's size, as the count
// that a header gives is often wrong.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sonarcal::data_io {

struct FramesBySize {
  int count = 0;                 // whole frames
  std::uint64_t rest_bytes = 0;  // behind the last of them
};

// frame_bytes > 0. A file shorter than its header has no frame and no rest. Throws DataError naming the file
// where there are more than an int can count.
FramesBySize CountFramesBySize(const std::string& file, std::uint64_t file_bytes, std::uint64_t header_bytes,
                               std::uint64_t frame_bytes);

// Adds a note where the header's count is another, and one where a last frame was cut short.
void NoteFrameCount(const FramesBySize& frames, std::int64_t header_says, std::vector<std::string>& notes);

}  // namespace sonarcal::data_io
