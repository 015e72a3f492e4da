// Frames of a comparison for the viewer in its report: as many as fit into a page of acceptable size, spread
// evenly over the recording, including the representative ones.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "apps/report/html/frame_viewer.h"
#include "core/types/image.h"
#include "metrics/compare.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal::report {

// Returns how many frames with this many pixels fit into one page: at most 7.5 MB of pictures (10 MB as text)
// even if they do not compress; at least three, at most `frames`.
std::size_t ViewerFrameCount(std::size_t pixels, std::size_t frames);

// `metrics.masks` must be set.
ViewerFrame MakeViewerFrame(const PolarImage& real, const PolarImage& simulated,
                            const metrics::FrameMetrics& metrics, metrics::IntensityDomain domain);

// Returns a sentence about the number of shown frames.
std::string ViewerCaption(std::size_t shown, std::size_t compared);

}  // namespace sonarcal::report
