// The paper's comparison on real frames of a target (TargetCase of apps/reproduce/case_plan.h). The pose is
// searched for on one frame. There both models are fitted, and then evaluated on another frame, beside the
// acoustic model of the search, which is not fitted.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/reproduce/case_plan.h"
#include "apps/workflow/fit.h"
#include "calib/acoustic_fit.h"
#include "calib/poses/pose_search.h"
#include "core/types/recording.h"

namespace sonarcal::reproduce {

struct TargetComparisonOptions {
  int threads = 0;
  bool quick = false;  // fewer starts and rays: to try the command, not for figures
  std::function<void(const std::string& line)> on_note = {};
};

struct TargetComparison {
  CasePlan plan;
  RecordingInfo info;
  calib::PoseSearchResult pose;
  ParameterSet acoustic;  // the model of the search, at the strength found
  workflow::RecordingFit paper;
  // The acoustic model of the search on the held-out frame: its expected image and kDraws speckled samples,
  // pooled, because a single one moves the occupancy by 0.02.
  metrics::MetricsReport acoustic_expected;
  metrics::MetricsReport acoustic_samples;

  struct Fitted {
    workflow::RecordingFit acoustic;  // without metrics and pictures, which are these
    // On the held-out frame; `samples` pools kDraws samples, too.
    metrics::MetricsReport expected;
    metrics::MetricsReport samples;
    std::vector<workflow::ComparedFrame> expected_frames;
    std::vector<workflow::ComparedFrame> sample_frames;  // of one sample
    metrics::MetricsReport floor;  // the expected image against those samples: the error that speckle leaves
  };
  static constexpr int kDraws = 8;
  Fitted fitted;
  metrics::MetricsReport real_against_real;  // the fitted frame in place of a simulated one
};

const TargetCase& TargetOf(const CasePlan& plan);

// The frames of the case, opened through recording.json in the folder of the case. Throws DataError if the
// folder `images`, the fitted frame or the held-out frame is missing.
std::unique_ptr<RecordingSource> OpenTarget(const CasePlan& plan, const std::filesystem::path& images);

// Data about the recording, with the water of the plan if the plan states one.
RecordingInfo InfoOf(const TargetCase& target, const RecordingSource& recorded);

// The start of the case with the display of the background of `image`.
ParameterSet TargetStart(const TargetCase& target, const PolarImage& image);

// The recorded frames as a fit takes them: each with the pose of the case, its scene, and the start.
struct PosedTarget {
  std::unique_ptr<MemoryRecording> recording;
  Scene scene;
  ParameterSet start;
};

// Throws DataError.
PosedTarget PoseTarget(const CasePlan& plan, const std::filesystem::path& images);

// Throws DataError.
TargetComparison CompareTarget(const CasePlan& plan, const std::filesystem::path& images,
                               const TargetComparisonOptions& options);

}  // namespace sonarcal::reproduce
