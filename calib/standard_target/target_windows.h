// Reads a recording and keeps of each frame the pixels about a small target, so that memory does not grow
// the images.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/standard_target/point_echo.h"
#include "calib/standard_target/target_sighting.h"
#include "core/types/parameters.h"
#include "core/types/pose.h"
#include "core/types/recording.h"

namespace sonarcal::calib {

struct FrameLeftOut {
  int frame = 0;
  std::string why;          // the same words for every frame with this reason
  std::string detail = {};  // what this frame shows
};

struct TargetWindows {
  // One a frame, in the order of the frames.
  std::vector<EchoWindow> windows;
  std::vector<TargetSighting> sightings;
  std::vector<std::optional<Pose>> poses;
  std::vector<FrameLeftOut> left_out;
  // Half-power extents of the echo: medians of the frames.
  double range_extent_m = 0.0;
  double azimuth_extent_rad = 0.0;
  double cell_pixels = 1.0;  // pixels of a resolution cell with correlated noise
};

// Windows reach three extents to each side. `frames`: empty for all. Throws DataError as ThrowNoTarget if no
// frame shows a target, and for frames with different axes or fewer than three beams.
TargetWindows FindTargetWindows(const RecordingSource& recording, const DisplayParameters<double>& display,
                                const TargetSearch& search, std::vector<int> frames,
                                const std::function<void(int done, int total)>& progress);

// Throws DataError with the reason that most frames give.
[[noreturn]] void ThrowNoTarget(const RecordingSource& recording, const std::vector<FrameLeftOut>& left_out);

}  // namespace sonarcal::calib
