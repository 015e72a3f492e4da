// A published comparison of a model with recordings (Park 2024, Section 6), start to end, on a SYNTHETIC
// recording, because the recordings were never published (SyntheticCase of apps/reproduce/case_plan.h). The
// coherent model (sim/coherent/coherent_image.h) makes the recorded side, with another image formation than
// the two models that are fitted: fields of point scatterers of random phase at the elements of an array,
// receiver noise at each element, a beamformer, a logarithmic display.
//
// The paper's model and the acoustic model are fitted to the same frames.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/reproduce/case_plan.h"
#include "apps/workflow/fit.h"

namespace sonarcal::reproduce {

struct SyntheticOptions {
  bool text_sizes = false;  // the sizes of the publication's text instead of its table
  std::uint64_t seed = 1;
  int threads = 0;
  bool quick = false;  // few rays and one start: to try the way, not for figures
  std::function<void(int done, int in_all)> on_frame = {};  // of the recording, as it is made
  std::function<void(const std::string& line)> on_note = {};
};

// Figures of one data set of the case, over its held-out frames.
struct SyntheticDataSet {
  std::vector<int> frames;
  metrics::Aggregate before;  // paper model
  metrics::Aggregate after;
  metrics::Aggregate acoustic_expected;  // acoustic model after its fit: the mean over speckle
  metrics::Aggregate acoustic_sample;    // and a speckled sample, from which occupancy is to be read
  double simulation_time_s = 0.0;        // mean of its frames, paper model at the paper's 1500 x 1200 rays
};

struct SyntheticComparison {
  CasePlan plan;
  Scene scene;
  ParameterSet truth;             // of the synthetic recording (coherent model)
  ParameterSet initial;           // the paper's Tables 4 and 5
  ParameterSet acoustic_initial;  // what one knows beforehand, for the acoustic model
  std::unique_ptr<MemoryRecording> recording;
  workflow::RecordingFit fit;               // of the paper's model
  workflow::RecordingFit acoustic;          // of the acoustic one
  std::vector<SyntheticDataSet> data_sets;  // in the order of the plan
  RayGridSize paper_rays;
  std::string absorption;  // a sentence: the formula of recording and models
};

const SyntheticCase& SyntheticOf(const CasePlan& plan);

// How the objects are found: in boxes about the scene's material `object_material`.
metrics::CompareOptions ObjectRules(const SyntheticCase& synthetic);

// Throws DataError if a fit has no usable solution.
SyntheticComparison CompareSynthetic(const CasePlan& plan, const SyntheticOptions& options);

}  // namespace sonarcal::reproduce
