// Key values of a recording for the page of `inspect`, its JSON form and reports.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/imaging/saturation.h"
#include "core/types/recording.h"

namespace sonarcal::data_io {

struct PixelSummary {
  double minimum = 0.0;  // in the units of the image's scale
  double median = 0.0;
  double maximum = 0.0;
  double at_minimum_fraction = 0.0;     // fraction of pixels with the lowest value of the scale
  double at_full_scale_fraction = 0.0;  // fraction of pixels with the highest value of the scale
};

struct RecordingSummary {
  double range_bin_m = 0.0;
  double azimuth_first_deg = 0.0;  // centre of the left-most beam
  double azimuth_last_deg = 0.0;
  double beam_spacing_mean_deg = 0.0;
  double beam_spacing_min_deg = 0.0;
  double beam_spacing_max_deg = 0.0;
  int frames_with_pose = 0;
  int frames_with_time = 0;
  std::optional<double> duration_s;  // first to last frame, if both have a time
  std::optional<PixelSummary> first_frame;
  // Traces of a saturated receiver in the first frame (core/imaging/saturation.h).
  std::vector<AzimuthStreak> streaks;
  std::optional<double> saturation_level;
  // reason why there is no first frame; empty if there is one, or if there are no frames
  std::string first_frame_failure;
  // Frames whose header cannot be read, and the reason for the first of them.
  int frames_without_header = 0;
  std::string header_failure;

  bool EvenBeams() const {
    return beam_spacing_max_deg - beam_spacing_min_deg < 1e-3 * beam_spacing_mean_deg;
  }
};

// Reads every frame's header and the first frame's pixels. Damaged frames do not end it.
RecordingSummary Summarize(const RecordingSource& recording);

}  // namespace sonarcal::data_io
