// The markers that a folder of pictures shows, picture by picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/marker_corners.h"
#include "data_io/camera_image.h"
#include "data_io/types/camera.h"
#include "data_io/types/marker_map.h"

namespace sonarcal {

struct MarkerImage {
  std::string unreadable;  // why there is no picture; empty: there is one
  std::vector<MarkerObservation> seen;
  std::vector<int> not_in_map;  // ids
  std::vector<int> seen_twice;
  std::vector<int> unclear;  // found, but too small, cut or blurred for their corners
};

// `port` null: none. A picture of another size than the camera's is unreadable.
MarkerImage FindMarkers(const std::filesystem::path& file, const MarkerMap& map, const Camera& camera,
                        const FlatPort* port);

}  // namespace sonarcal
