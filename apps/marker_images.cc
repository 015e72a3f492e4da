#include "apps/marker_images.h"

#include <fmt/format.h>

#include "data_io/marker_detector.h"
#include "data_io/marker_map_io.h"
#include "data_io/types/error.h"

namespace sonarcal {

MarkerImage FindMarkers(const std::filesystem::path& file, const MarkerMap& map, const Camera& camera,
                        const FlatPort* port) {
  MarkerImage image;
  Grid<std::uint8_t> grey;
  try {
    grey = ReadCameraImage(file);
  } catch (const DataError& error) {
    image.unreadable = error.what();
    return image;
  }
  if (grey.rows() != camera.rows || grey.cols() != camera.cols) {
    image.unreadable = fmt::format("{}: {} x {} pixels, expected the camera's {} x {} (columns x rows)",
                                   file.string(), grey.cols(), grey.rows(), camera.cols, camera.rows);
    return image;
  }
  const MarkersSeen seen = MarkerDetector(map.dictionary).Detect(grey);
  image.seen_twice = seen.seen_twice;
  const int cells = FindMarkerDictionary(map.dictionary)->cells;
  for (const MarkerQuad& quad : seen.markers) {
    const Marker* marker = map.Find(quad.id);
    if (marker == nullptr) {
      image.not_in_map.push_back(quad.id);
      continue;
    }
    const auto refined = RefineMarkerCorners(grey, quad, {cells, marker->size_m}, camera, port);
    if (refined) {
      image.seen.push_back(*refined);
    } else {
      image.unclear.push_back(quad.id);
    }
  }
  return image;
}

}  // namespace sonarcal
