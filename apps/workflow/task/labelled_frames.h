// Frames of a recording with the pixels of the object, to train and test a detector
// (metrics/task/transfer.h). All frames are kept in memory.
#pragma once

#include <string>
#include <vector>

#include "core/types/recording.h"
#include "core/types/scene.h"
#include "metrics/task/pixel_detector.h"

namespace sonarcal::workflow {

// `masks`: recording of the same frames in the same order. A pixel of at least half of its full scale is
// object. Throws DataError if frames or shapes differ.
std::vector<metrics::LabelledFrame> LabelledByMasks(const RecordingSource& recording,
                                                    const RecordingSource& masks);

// The object is where rays show the material, from the recorded pose of each frame
// (apps/workflow/scene_geometry.h). Throws DataError if the scene has no such material or a frame has no
// pose.
std::vector<metrics::LabelledFrame> LabelledByScene(const RecordingSource& recording, const Scene& scene,
                                                    const std::string& material);

}  // namespace sonarcal::workflow
