#include "data_io/recordings/recording_summary.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "core/math/statistics.h"
#include "core/types/units.h"

namespace sonarcal::data_io {
namespace {

PixelSummary SummarizePixels(const PolarImage& image) {
  std::vector<float> values(image.value.values().begin(), image.value.values().end());
  PixelSummary summary;
  summary.median = UpperMedian(values);
  summary.minimum = *std::min_element(values.begin(), values.end());
  summary.maximum = *std::max_element(values.begin(), values.end());
  // Only a grey scale clips; in decibels or power the extremes are not clipped.
  if (image.scale.quantity == Quantity::kGrey) {
    const auto fraction_of = [&](double value) {
      const auto count = std::count(values.begin(), values.end(), static_cast<float>(value));
      return static_cast<double>(count) / static_cast<double>(values.size());
    };
    summary.at_minimum_fraction = fraction_of(0.0);
    summary.at_full_scale_fraction = fraction_of(image.scale.full_scale);
  }
  return summary;
}

void SummarizeBeams(const std::vector<double>& azimuth_rad, RecordingSummary& summary) {
  summary.azimuth_first_deg = DegFromRad(azimuth_rad.front());
  summary.azimuth_last_deg = DegFromRad(azimuth_rad.back());
  const auto gaps = static_cast<double>(azimuth_rad.size() - 1);
  summary.beam_spacing_mean_deg = (summary.azimuth_last_deg - summary.azimuth_first_deg) / gaps;
  summary.beam_spacing_min_deg = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < azimuth_rad.size(); ++i) {
    const double spacing_deg = DegFromRad(azimuth_rad[i] - azimuth_rad[i - 1]);
    summary.beam_spacing_min_deg = std::min(summary.beam_spacing_min_deg, spacing_deg);
    summary.beam_spacing_max_deg = std::max(summary.beam_spacing_max_deg, spacing_deg);
  }
}

void SummarizeFrames(const RecordingSource& recording, RecordingSummary& summary) {
  std::optional<double> first_s;
  std::optional<double> last_s;
  for (int i = 0; i < recording.frame_count(); ++i) {
    FrameInfo frame;
    try {
      frame = recording.frame_info(i);
    } catch (const DataError& error) {
      if (summary.frames_without_header++ == 0) summary.header_failure = error.what();
    }
    if (frame.world_from_sonar) ++summary.frames_with_pose;
    if (frame.time_s) ++summary.frames_with_time;
    if (i == 0) first_s = frame.time_s;
    last_s = frame.time_s;
  }
  if (first_s && last_s) summary.duration_s = *last_s - *first_s;
}

}  // namespace

RecordingSummary Summarize(const RecordingSource& recording) {
  const PolarAxes& axes = recording.info().sonar.axes;
  RecordingSummary summary;
  summary.range_bin_m = axes.range_bin_m();
  if (axes.beam_count() >= 2) SummarizeBeams(axes.beam_azimuth_rad, summary);
  SummarizeFrames(recording, summary);
  if (recording.frame_count() > 0) {
    try {
      const Frame frame = recording.ReadFrame(0);
      if (frame.image.value.empty()) return summary;
      summary.first_frame = SummarizePixels(frame.image);
      if (frame.image.scale.quantity == Quantity::kGrey) {
        const std::optional<Mask>& valid = recording.info().valid;
        summary.streaks = FindAzimuthStreaks(frame.image, valid ? &*valid : nullptr);
        summary.saturation_level = FindSaturationLevel(frame.image);
      }
    } catch (const DataError& error) {
      summary.first_frame_failure = error.what();
    }
  }
  return summary;
}

}  // namespace sonarcal::data_io
