// Recording whose grey values have no levels, such as floats of 0..1. Fits and simulations take 1 for a
// level, so the values are read as 0..65535. They keep their fractions.
#pragma once

#include <memory>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// Returns `recording` itself if its values have levels, are no grey values, or have a larger full scale.
// Otherwise a note says what is read.
std::unique_ptr<RecordingSource> WithLevels(std::unique_ptr<RecordingSource> recording);

}  // namespace sonarcal::data_io
