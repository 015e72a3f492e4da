// The paper's comparison on a real sonar's frames: two frames of a bomb recorded by an ARIS 3000
// (data_io/sonars/aris3000_frames_io.h). Models are fitted on the first frame and judged on the other, twice:
//
//   - both with outline and pose of calib/bomb_fit.h, found beforehand on the first frame: what the
//   models do
//     where the geometry is as good as it gets;
//   - the paper's with a plain outline and the pose that a search on the first frame finds here, from
//     nothing, beside the acoustic one not fitted.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/report/pictures/comparison_pictures.h"
#include "apps/workflow/fit.h"
#include "calib/acoustic_fit.h"
#include "calib/poses/pose_search.h"

namespace sonarcal::reproduce {

struct BombComparisonOptions {
  int threads = 0;
  bool quick = false;  // fewer starts and rays: to try the way, not for figures
  metrics::CompareOptions comparison;
  std::function<void(const std::string& line)> on_note = {};
};

struct BombComparison {
  RecordingInfo info;
  calib::PoseSearchResult pose;
  ParameterSet acoustic;       // the model that the pose was found with, at the strength found
  workflow::RecordingFit fit;  // of the paper model
  // The acoustic model on the held-out frame: its expected image, and one speckled sample of it.
  metrics::MetricsReport acoustic_expected;
  metrics::MetricsReport acoustic_sample;
  std::vector<report::FramePictures> acoustic_pictures;

  // With outline and pose of calib/bomb_fit.h.
  struct Fitted {
    workflow::RecordingFit paper;
    workflow::RecordingFit acoustic;  // without metrics and pictures, which are these
    // On the held-out frame. Samples: kDraws of them, beside the same recorded frame, as one moves the
    // occupancy by 0.02.
    metrics::MetricsReport expected;
    metrics::MetricsReport samples;
    std::vector<report::FramePictures> expected_pictures;
    std::vector<report::FramePictures> sample_pictures;  // of one
    metrics::MetricsReport
        floor;  // the expected image against those samples: no image without speckle is nearer
  };
  static constexpr int kDraws = 8;
  Fitted fitted;
  metrics::MetricsReport
      real_against_real;  // the first frame in place of a simulated one: same speckle, other noise
};

// The display read off what `segmentation` calls background (calib/noise/background_display.h).
DisplayParameters<double> DisplayOfBackground(const PolarImage& image,
                                              const metrics::SegmentationOptions& segmentation);

// The recorded frames as a fit of the acoustic model takes them: each with the pose that was found beforehand
// (calib/bomb_fit.h), the outline as scene, and the parameters to start from.
struct KnownBomb {
  std::unique_ptr<MemoryRecording> recording;
  Scene scene;
  ParameterSet initial;
};

// `folder` as OpenAris3000Frames takes it; the display is read off what `segmentation` calls background.
// Throws DataError.
KnownBomb PrepareBomb(const std::filesystem::path& folder,
                      const metrics::SegmentationOptions& segmentation = {});

// `folder` as OpenAris3000Frames takes it. Throws DataError.
BombComparison CompareBomb(const std::filesystem::path& folder, const BombComparisonOptions& options);

}  // namespace sonarcal::reproduce
