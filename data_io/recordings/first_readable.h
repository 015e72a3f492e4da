// Description of a recording from the first of its frames that can be read, so that one damaged frame does
// not hide the others.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "core/types/error.h"
#include "core/types/recording.h"

namespace sonarcal::data_io {

// Calls `describe(index, info)` for one frame after the other until it does not throw DataError. Returns the
// index of that frame. A call that throws does not change `info`. Adds a note if the frame is not the first.
// `word` names a frame, such as "ping". Throws DataError with the error of the first frame if none of the
// first 100 can be read.
template <typename Describe>
int DescribeFromFirstReadable(int frame_count, std::string_view word, RecordingInfo& info,
                              const Describe& describe) {
  constexpr int kMaxTries = 100;
  const int tried = std::min(frame_count, kMaxTries);
  std::string of_first;
  for (int index = 0; index < tried; ++index) {
    RecordingInfo described = info;
    try {
      describe(index, described);
    } catch (const DataError& error) {
      if (index == 0) of_first = error.what();
      continue;
    }
    info = std::move(described);
    if (index > 0) {
      info.notes.push_back(fmt::format("The sonar is described from {} {}, the first that can be read: {}.",
                                       word, index, of_first));
    }
    return index;
  }
  throw DataError("{}{}", of_first,
                  tried == 1 ? "" : fmt::format("; none of the first {} {}s can be read", tried, word));
}

}  // namespace sonarcal::data_io
