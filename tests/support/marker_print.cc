#include "tests/support/marker_print.h"

#include <opencv2/aruco.hpp>
#include <opencv2/core.hpp>

namespace sonarcal::testing {
namespace {

// OpenCV 4.6 returns dictionaries as pointers, later versions as values.
[[maybe_unused]] const cv::aruco::Dictionary& Value(const cv::Ptr<cv::aruco::Dictionary>& dictionary) {
  return *dictionary;
}
[[maybe_unused]] const cv::aruco::Dictionary& Value(const cv::aruco::Dictionary& dictionary) {
  return dictionary;
}

// Draws a print under the name that this version of OpenCV has for it.
template <typename Dictionary>
cv::Mat Draw(const Dictionary& dictionary, int id, int side_px) {
  cv::Mat print;
  if constexpr (requires { dictionary.generateImageMarker(id, side_px, print, 1); }) {
    dictionary.generateImageMarker(id, side_px, print, 1);
  } else {
    dictionary.drawMarker(id, side_px, print, 1);
  }
  return print;
}

}  // namespace

MarkerDictionarySize SizeOfMarkerDictionary(int opencv_code) {
  const auto found = cv::aruco::getPredefinedDictionary(opencv_code);
  const cv::aruco::Dictionary& dictionary = Value(found);
  return {.ids = dictionary.bytesList.rows, .cells = dictionary.markerSize + 2};
}

Grid<std::uint8_t> MarkerPrint(int opencv_code, int id, int side_px) {
  const auto found = cv::aruco::getPredefinedDictionary(opencv_code);
  const cv::Mat print = Draw(Value(found), id, side_px);
  Grid<std::uint8_t> cells(print.rows, print.cols);
  for (int r = 0; r < print.rows; ++r) {
    for (int c = 0; c < print.cols; ++c) cells(r, c) = print.at<std::uint8_t>(r, c);
  }
  return cells;
}

}  // namespace sonarcal::testing
