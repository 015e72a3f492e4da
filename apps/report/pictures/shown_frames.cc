#include "apps/report/pictures/shown_frames.h"

#include <algorithm>

#include "apps/report/pictures/comparison_viewer.h"
#include "core/types/error.h"

namespace sonarcal::report {
namespace {

// Collects the pictures of successive frames.
class FrameShow {
 public:
  FrameShow(std::vector<int> examples, metrics::IntensityDomain domain)
      : examples_(std::move(examples)), domain_(domain) {}

  void Add(const PolarImage& real, const PolarImage& simulated, const metrics::FrameMetrics& metrics) {
    shown_.viewer.frames.push_back(MakeViewerFrame(real, simulated, metrics, domain_));
    if (std::ranges::find(examples_, metrics.index) == examples_.end()) return;
    shown_.examples.push_back({real, simulated, metrics});
  }

  ShownFrames Finish(bool real_is_synthetic, std::size_t compared) {
    shown_.viewer.real_is_synthetic = real_is_synthetic;
    shown_.viewer.caption = ViewerCaption(shown_.viewer.frames.size(), compared);
    return std::move(shown_);
  }

 private:
  std::vector<int> examples_;
  metrics::IntensityDomain domain_;
  ShownFrames shown_;
};

// Returns the frames of a report for the viewer of one page.
std::vector<int> ViewedFrames(const metrics::MetricsReport& report, const std::vector<int>& examples,
                              std::size_t pixels, std::size_t max_frames) {
  return workflow::SpreadFrames(report, examples, ViewerFrameCount(pixels, max_frames));
}

}  // namespace

ShownFrames ShowFrames(const RecordingSource& real, const RecordingSource& simulated,
                       const workflow::CompareRecordingsOptions& options,
                       const metrics::MetricsReport& report, const std::vector<int>& examples) {
  const PolarAxes& axes = real.info().sonar.axes;
  const std::size_t pixels = static_cast<std::size_t>(axes.range_bins) * axes.beam_count();
  FrameShow show(examples, options.compare.intensity_domain);
  workflow::CompareAgain(
      real, simulated, options, ViewedFrames(report, examples, pixels, report.frames.size()),
      [&](const PolarImage& recorded, const PolarImage& rendered, const metrics::FrameMetrics& metrics) {
        show.Add(recorded, rendered, metrics);
      });
  return show.Finish(real.info().synthetic, report.frames.size());
}

ShownFrames ShowFit(const workflow::RecordingFit& fit) {
  if (fit.frames_after.empty()) return {};
  std::vector<int> examples;
  for (const workflow::ComparedFrame& frame : fit.frames_before) examples.push_back(frame.metrics.index);
  const std::size_t pixels = fit.frames_after.front().real.value.size();
  const std::vector<int> viewed = ViewedFrames(fit.after, examples, pixels, fit.frames_after.size());
  FrameShow show(examples, fit.after.options.intensity_domain);
  for (const workflow::ComparedFrame& frame : fit.frames_after) {
    if (std::ranges::find(viewed, frame.metrics.index) == viewed.end()) continue;
    show.Add(frame.real, frame.simulated, frame.metrics);
  }
  return show.Finish(fit.after.real_is_synthetic, fit.after.frames.size());
}

const workflow::ComparedFrame& MiddleFrame(const std::vector<workflow::ComparedFrame>& frames,
                                           metrics::IntensityDomain domain) {
  SONARCAL_CHECK(!frames.empty(), "no frame");
  std::vector<const workflow::ComparedFrame*> by_error;
  for (const workflow::ComparedFrame& frame : frames) by_error.push_back(&frame);
  std::ranges::stable_sort(by_error, {}, [&](const workflow::ComparedFrame* frame) {
    return frame->metrics.polar.intensity.Over(domain).mean_absolute().value_or(1.0);
  });
  return *by_error[by_error.size() / 2];
}

}  // namespace sonarcal::report
