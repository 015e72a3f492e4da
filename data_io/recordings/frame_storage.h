// Storage of a recording's frames in files of one geometry and one scale: bits of the samples, and checks of
// each frame.
#pragma once

#include <string>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// Returns the bits that hold the whole grey levels 0 .. full_scale, 8 or 16. Returns 32 (float) where there
// are no such levels: for other quantities, and for a full scale that is not whole, at most 1 or above 65535.
int MinBits(const ImageScale& scale);

// Throws DataError, naming `what`, if a value is not finite or, if grey, outside 0 .. full_scale.
void CheckValues(const PolarImage& image, const std::string& what);

// Throws DataError if the frame differs from `info`, which describes the first frame, in axes or scale.
void CheckSameAsFirst(const RecordingInfo& info, const Frame& frame, int index);

}  // namespace sonarcal::data_io
