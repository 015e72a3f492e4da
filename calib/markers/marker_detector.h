// Markers in an image, by OpenCV's ArUco detector, which knows AprilTag's dictionaries too. Corners come as
// the detector's contours give them, to about a pixel: calib/markers/marker_corners.h refines them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/types/image.h"
#include "core/types/marker_map.h"

namespace sonarcal::calib {

struct MarkersSeen {
  std::vector<MarkerQuad> markers;  // by id, each once
  std::vector<int> seen_twice;      // ids that several places of the image show: none of them can be believed
};

// `dictionary` is one of MarkerDictionaries() (data_io/parameters/marker_map_io.h).
class MarkerDetector {
 public:
  explicit MarkerDetector(const std::string& dictionary);

  // An image of any size; one too small to hold a marker shows none.
  MarkersSeen Detect(const Grid<std::uint8_t>& grey) const;

 private:
  int opencv_code_;
};

}  // namespace sonarcal::calib
