#include "apps/workflow/task/labelled_frames.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "apps/workflow/scene_geometry.h"
#include "core/types/error.h"

namespace sonarcal::workflow {
namespace {

metrics::LabelledFrame FrameOf(Frame read) {
  PolarImage& image = read.image;
  metrics::LabelledFrame frame{.value = std::move(image.value),
                               .full_scale = image.scale.full_scale,
                               .object = {},
                               .time_s = read.info.time_s};
  frame.object = Mask(frame.value.rows(), frame.value.cols());
  return frame;
}

}  // namespace

std::vector<metrics::LabelledFrame> LabelledByMasks(const RecordingSource& recording,
                                                    const RecordingSource& masks) {
  if (recording.frame_count() != masks.frame_count()) {
    throw DataError("{}: has {} masks, expected one for each of the {} frames of {}", masks.info().source,
                    masks.frame_count(), recording.frame_count(), recording.info().source);
  }
  std::vector<metrics::LabelledFrame> frames;
  for (int i = 0; i < recording.frame_count(); ++i) {
    metrics::LabelledFrame& frame = frames.emplace_back(FrameOf(recording.ReadFrame(i)));
    const PolarImage mask = masks.ReadFrame(i).image;
    if (mask.value.rows() != frame.value.rows() || mask.value.cols() != frame.value.cols()) {
      throw DataError("{}: mask {} has {} x {} pixels, expected the frame's {} x {}", masks.info().source, i,
                      mask.value.rows(), mask.value.cols(), frame.value.rows(), frame.value.cols());
    }
    const double half = 0.5 * mask.scale.full_scale;
    std::ranges::transform(mask.value.values(), frame.object.values().begin(),
                           [half](float value) { return std::uint8_t{value >= half}; });
  }
  return frames;
}

std::vector<metrics::LabelledFrame> LabelledByScene(const RecordingSource& recording, const Scene& scene,
                                                    const std::string& material) {
  const SceneGeometry geometry(scene, recording.info().sonar);
  CheckObject({.material = material}, geometry.material_names());
  const auto name = std::ranges::find(geometry.material_names(), material);
  const auto index = static_cast<int>(name - geometry.material_names().begin());
  std::vector<metrics::LabelledFrame> frames;
  for (int i = 0; i < recording.frame_count(); ++i) {
    Frame read = recording.ReadFrame(i);
    if (!read.info.world_from_sonar) {
      throw DataError("{}: frame {} has no pose, expected one to label the material '{}'",
                      recording.info().source, i, material);
    }
    const CellGeometry cells = geometry.At(*read.info.world_from_sonar);
    metrics::LabelledFrame& frame = frames.emplace_back(FrameOf(std::move(read)));
    if (cells.material.rows() != frame.value.rows() || cells.material.cols() != frame.value.cols()) {
      throw DataError("{}: frame {} has {} x {} pixels, expected the recording's {} x {}",
                      recording.info().source, i, frame.value.rows(), frame.value.cols(),
                      cells.material.rows(), cells.material.cols());
    }
    std::ranges::transform(cells.material.values(), frame.object.values().begin(),
                           [index](int of) { return std::uint8_t{of == index}; });
  }
  return frames;
}

}  // namespace sonarcal::workflow
