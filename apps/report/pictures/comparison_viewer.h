// The frames of a comparison that its report lets a reader go through: as many as fit into a page that is
// still handed around, spread evenly over the recording, the telling ones among them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "apps/report/html/frame_viewer.h"
#include "core/types/image.h"
#include "metrics/compare.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal::report {

// How many frames of this many pixels go into one page: its pictures take 7.5 MB at most (10 MB as text),
// however badly they compress; at least three, at most `frames`.
std::size_t ViewerFrameCount(std::size_t pixels, std::size_t frames);

// `metrics.masks` must be set.
ViewerFrame MakeViewerFrame(const PolarImage& real, const PolarImage& simulated,
                            const metrics::FrameMetrics& metrics, metrics::IntensityDomain domain);

// Says how many of the compared frames are shown.
std::string ViewerCaption(std::size_t shown, std::size_t compared);

}  // namespace sonarcal::report
