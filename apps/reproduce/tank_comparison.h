// The paper's tank comparison (Park 2024, Section 6), start to end, on a SYNTHETIC recording: the paper's own
// were never published. The recorded side is made by the coherent model (sim/coherent/coherent_image.h),
// another image formation than the two that are fitted: fields of point scatterers of random phase at the
// elements of an array, receiver noise at each element, a beamformer, a logarithmic display.
//
// The paper's model is fitted to it, and the acoustic one, on the same frames.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/workflow/fit.h"
#include "sim/scenes/scenes.h"

namespace sonarcal::reproduce {

inline constexpr int kTankDataSets = 3;

struct TankComparisonOptions {
  sim::PaperSize size = sim::PaperSize::kTable5;
  std::uint64_t seed = 1;
  int threads = 0;
  bool quick = false;  // few rays and one start: to try the way, not for figures
  metrics::CompareOptions comparison;
  std::function<void(int done, int in_all)> on_frame = {};  // of the recording, as it is made
  std::function<void(const std::string& line)> on_note = {};
};

// Figures of one of the paper's three data sets, over its held-out frames.
struct TankDataSet {
  std::vector<int> frames;
  metrics::Aggregate before;  // paper model
  metrics::Aggregate after;
  metrics::Aggregate acoustic_expected;  // acoustic model after its fit: the mean over speckle
  metrics::Aggregate acoustic_sample;    // and a speckled sample, from which occupancy is to be read
  double simulation_time_s = 0.0;        // mean of its frames, paper model at the paper's 1500 x 1200 rays
};

struct TankComparison {
  Scene scene;
  ParameterSet truth;             // of the synthetic recording (coherent model)
  ParameterSet initial;           // the paper's Tables 4 and 5
  ParameterSet acoustic_initial;  // what one knows beforehand, for the acoustic model
  std::unique_ptr<MemoryRecording> recording;
  workflow::RecordingFit fit;       // of the paper's model
  workflow::RecordingFit acoustic;  // of the acoustic one
  std::array<TankDataSet, kTankDataSets> data_sets;
  RayGridSize paper_rays;
  std::string absorption;  // a sentence: the formula of recording and models
};

// How the mock-ups are found.
metrics::CompareOptions TankRules();

// Throws DataError where a fit has no usable solution.
TankComparison CompareTank(const TankComparisonOptions& options);

}  // namespace sonarcal::reproduce
