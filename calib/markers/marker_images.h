// Markers in a folder of pictures, picture by picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/markers/marker_corners.h"
#include "calib/markers/marker_detector.h"
#include "core/types/camera.h"
#include "core/types/marker_map.h"
#include "data_io/images/camera_image.h"

namespace sonarcal::calib {

struct MarkerImage {
  std::string unreadable;  // reason why the picture cannot be used; empty: it can
  std::vector<MarkerObservation> seen;
  std::vector<int> not_in_map;  // ids
  std::vector<int> seen_twice;
  std::vector<int> unclear;  // found, but too small, cut off or blurred for their corners
};

// Finds markers in one picture after the other, with one detector.
class MarkerFinder {
 public:
  // `port`: null for none. All three must outlive this object.
  MarkerFinder(const MarkerMap& map, const Camera& camera, const FlatPort* port);

  // A picture with another size than the camera's counts as unreadable.
  MarkerImage Find(const std::filesystem::path& file) const;

 private:
  const MarkerMap& map_;
  const Camera& camera_;
  const FlatPort* port_;
  MarkerDetector detector_;
  int cells_ = 0;  // along a marker's side
};

}  // namespace sonarcal::calib
