// Marker maps as JSON, and the dictionaries of markers.
//
//   {"format": "sonar-markers/1", "dictionary": "DICT_4X4_50",
//    "markers": [{"id": 3, "size_m": 0.15,
//                 "world_from_marker": {"position_m": [x, y, z], "quaternion_wxyz": [w, x, y, z]}}],
//    "sigma": {"position_m": 0.002, "angle_deg": 0.5}}
//
// Axes and corners of a marker: core/types/marker_map.h. Without `sigma` the map is exact. The dictionary is
// one of OpenCV's, ArUco's or AprilTag's. Rejected: ids that the dictionary does not have, duplicate ids,
// sizes outside 1 mm .. 100 m, more than 10,000 markers. Throws DataError with file, line and key.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "core/types/marker_map.h"

namespace sonarcal::data_io {

struct MarkerDictionary {
  std::string_view name;
  int opencv_code = 0;  // cv::aruco::PREDEFINED_DICTIONARY_NAME
  int cells = 0;        // cells along a side, including the black border of one cell
  int ids = 0;          // 0 .. ids - 1
};

const std::vector<MarkerDictionary>& MarkerDictionaries();
const MarkerDictionary* FindMarkerDictionary(std::string_view name);  // null if there is none

MarkerMap ReadMarkerMap(const std::filesystem::path& file);
void WriteMarkerMap(const std::filesystem::path& file, const MarkerMap& map);

}  // namespace sonarcal::data_io
