#include "calib/markers/marker_detector.h"

#include <algorithm>
#include <map>

#include <opencv2/aruco.hpp>
#include <opencv2/core.hpp>

#include "core/types/error.h"
#include "data_io/parameters/marker_map_io.h"

namespace sonarcal::calib {
namespace {

// OpenCV 4.6 returns dictionaries as pointers, later versions as values.
using DictionaryPointer = cv::Ptr<cv::aruco::Dictionary>;
[[maybe_unused]] DictionaryPointer Shared(const DictionaryPointer& dictionary) {
  return dictionary;
}
[[maybe_unused]] DictionaryPointer Shared(const cv::aruco::Dictionary& dictionary) {
  return cv::makePtr<cv::aruco::Dictionary>(dictionary);
}

}  // namespace

MarkerDetector::MarkerDetector(const std::string& dictionary) {
  const data_io::MarkerDictionary* found = data_io::FindMarkerDictionary(dictionary);
  SONARCAL_CHECK(found != nullptr, "dictionary {}", dictionary);
  opencv_code_ = found->opencv_code;
}

MarkersSeen MarkerDetector::Detect(const Grid<std::uint8_t>& grey) const {
  MarkersSeen seen;
  constexpr int kLeastPx = 16;
  if (grey.rows() < kLeastPx || grey.cols() < kLeastPx) return seen;
  // OpenCV only reads the data, but its header has no const form.
  const cv::Mat image(grey.rows(), grey.cols(), CV_8UC1, const_cast<std::uint8_t*>(grey.values().data()));
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(image, Shared(cv::aruco::getPredefinedDictionary(opencv_code_)), corners, ids);
  std::map<int, std::vector<MarkerQuad>> by_id;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    MarkerQuad quad;
    quad.id = ids[i];
    for (std::size_t k = 0; k < 4; ++k) quad.corners_px[k] = {corners[i][k].x, corners[i][k].y};
    by_id[ids[i]].push_back(quad);
  }
  for (const auto& [id, quads] : by_id) {
    if (quads.size() == 1) {
      seen.markers.push_back(quads.front());
    } else {
      seen.seen_twice.push_back(id);
    }
  }
  return seen;
}

}  // namespace sonarcal::calib
