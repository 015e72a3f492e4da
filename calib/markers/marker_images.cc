#include "calib/markers/marker_images.h"

#include <fmt/format.h>

#include "core/types/error.h"
#include "data_io/parameters/marker_map_io.h"

namespace sonarcal::calib {

MarkerFinder::MarkerFinder(const MarkerMap& map, const Camera& camera, const FlatPort* port)
    : map_(map),
      camera_(camera),
      port_(port),
      detector_(map.dictionary),
      cells_(data_io::FindMarkerDictionary(map.dictionary)->cells) {}

MarkerImage MarkerFinder::Find(const std::filesystem::path& file) const {
  MarkerImage image;
  Grid<std::uint8_t> grey;
  try {
    grey = data_io::ReadCameraImage(file);
  } catch (const DataError& error) {
    image.unreadable = error.what();
    return image;
  }
  if (grey.rows() != camera_.rows || grey.cols() != camera_.cols) {
    image.unreadable = fmt::format("{}: {} x {} pixels, expected the camera's {} x {} (columns x rows)",
                                   file.string(), grey.cols(), grey.rows(), camera_.cols, camera_.rows);
    return image;
  }
  const MarkersSeen seen = detector_.Detect(grey);
  image.seen_twice = seen.seen_twice;
  for (const MarkerQuad& quad : seen.markers) {
    const Marker* marker = map_.Find(quad.id);
    if (marker == nullptr) {
      image.not_in_map.push_back(quad.id);
      continue;
    }
    const auto refined = RefineMarkerCorners(grey, quad, {cells_, marker->size_m}, camera_, port_);
    if (refined) {
      image.seen.push_back(*refined);
    } else {
      image.unclear.push_back(quad.id);
    }
  }
  return image;
}

}  // namespace sonarcal::calib
