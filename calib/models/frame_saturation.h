// Traces of a saturated receiver in the frames of a fit (core/imaging/saturation.h), and what the fit does
// with them. The range bins of a streak do not count. Pixels at the level where values pile up stand for all
// higher powers, as those at full scale do: to leave out pixels because they are bright would make the rest
// too dark. A fit of the paper's model, which knows no such pixels, leaves them out. A fit of a noise law
// takes their level as it is.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/imaging/saturation.h"
#include "core/types/recording.h"

namespace sonarcal::calib {

struct FrameSaturation {
  int frame = 0;                // index in the recording
  std::optional<double> level;  // grey level at which values pile up, below full scale
  std::int64_t pixels_at_level = 0;
  std::vector<AzimuthStreak> streaks;
};

// Absent without any trace.
std::optional<FrameSaturation> FindSaturation(int frame, const PolarImage& image,
                                              const std::optional<Mask>& valid);

// Frames with a trace, among those with these indices.
std::vector<FrameSaturation> FindSaturation(const RecordingSource& recording, const std::vector<int>& frames);

// Sets `use` of the bins of streaks to 0. `use`: range_bins x beams; empty: all pixels count.
void LeaveOutStreaks(const PolarImage& image, const std::optional<Mask>& valid,
                     std::vector<std::uint8_t>& use);

// As above, and for the pixels at the level where values pile up.
void LeaveOutSaturated(const PolarImage& image, const std::optional<Mask>& valid,
                       std::vector<std::uint8_t>& use);

// Tells in one sentence what was found, without a full stop; empty if nothing was.
std::string SaturationText(const std::vector<FrameSaturation>& saturation);

}  // namespace sonarcal::calib
