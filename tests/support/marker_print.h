// Markers as OpenCV knows them, for every version of OpenCV that the project builds with.
#pragma once

#include <cstdint>

#include "core/types/image.h"

namespace sonarcal::testing {

// Size of one of OpenCV's predefined dictionaries.
struct MarkerDictionarySize {
  int ids = 0;
  int cells = 0;  // along a side, black border included
};

// `opencv_code` is a value of cv::aruco::PREDEFINED_DICTIONARY_NAME.
MarkerDictionarySize SizeOfMarkerDictionary(int opencv_code);

// Print of marker `id`, `side_px` square, with a black border of one cell. Row 0 is on top, 0 is black.
Grid<std::uint8_t> MarkerPrint(int opencv_code, int id, int side_px);

}  // namespace sonarcal::testing
