// Finds markers in an image with OpenCV's ArUco detector, which also knows AprilTag dictionaries. Corners
// come from the contours of the detector, to about a pixel; calib/markers/marker_corners.h refines them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/types/image.h"
#include "core/types/marker_map.h"

namespace sonarcal::calib {

struct MarkersSeen {
  std::vector<MarkerQuad> markers;  // by id, each once
  std::vector<int> seen_twice;      // ids found at several places of the image; none of them is reliable
};

// `dictionary` is one of MarkerDictionaries() (data_io/parameters/marker_map_io.h).
class MarkerDetector {
 public:
  explicit MarkerDetector(const std::string& dictionary);

  // Accepts an image of any size. One that is too small for a marker gives none.
  MarkersSeen Detect(const Grid<std::uint8_t>& grey) const;

 private:
  int opencv_code_;
};

}  // namespace sonarcal::calib
