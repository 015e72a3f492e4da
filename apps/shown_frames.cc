#include "apps/shown_frames.h"

#include <algorithm>

#include "apps/comparison_viewer.h"

namespace sonarcal {

ShownFrames ShowFrames(const RecordingSource& real, const RecordingSource& simulated,
                       const CompareRecordingsOptions& options, const MetricsReport& report,
                       const std::vector<int>& telling, std::size_t most) {
  const PolarAxes& axes = real.info().sonar.axes;
  const std::size_t pixels = static_cast<std::size_t>(axes.range_bins) * axes.beam_count();
  const std::size_t compared = report.frames.size();
  CompareRecordingsOptions again = options;
  again.frames = SpreadFrames(report, telling, std::min(most, ViewerFrameCount(pixels, compared)));
  again.noise_floor = false;
  again.compare.sweep = {};
  again.progress = {};
  ShownFrames shown;
  PictureMaker maker;
  CompareRecordings(real, simulated, again,
                    [&](const PolarImage& recorded, const PolarImage& rendered, const FrameMetrics& metrics) {
                      shown.viewer.frames.push_back(
                          MakeViewerFrame(recorded, rendered, metrics, options.compare.intensity_domain));
                      if (std::ranges::find(telling, metrics.index) == telling.end()) return;
                      shown.telling.push_back(maker.Make(recorded, rendered, metrics));
                    });
  shown.viewer.real_is_synthetic = real.info().synthetic;
  shown.viewer.caption = ViewerCaption(shown.viewer.frames.size(), compared);
  return shown;
}

}  // namespace sonarcal
