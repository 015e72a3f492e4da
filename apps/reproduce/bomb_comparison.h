// The paper's comparison on a real sonar's frames: two frames of a bomb recorded by an ARIS 3000
// (data_io/aris3000_frames_io.h). No pose was recorded, so it is searched for on the first frame; the paper
// model's parameters are fitted on that frame and judged on the other.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/fit_recording.h"
#include "calib/pose_search.h"

namespace sonarcal {

struct BombComparisonOptions {
  int threads = 0;
  bool quick = false;  // fewer starts and rays: to try the way, not for figures
  CompareOptions comparison;
  std::function<void(const std::string& line)> on_note = {};
};

struct BombComparison {
  RecordingInfo info;
  PoseSearchResult pose;
  ParameterSet acoustic;  // the model that the pose was found with, at the strength found
  RecordingFit fit;       // of the paper model
  // The acoustic model on the held-out frame: its expected image, and one speckled sample of it.
  MetricsReport acoustic_expected;
  MetricsReport acoustic_sample;
  std::vector<FramePictures> acoustic_pictures;
};

// `folder` as OpenAris3000Frames takes it. Throws DataError.
BombComparison CompareBomb(const std::filesystem::path& folder, const BombComparisonOptions& options);

}  // namespace sonarcal
