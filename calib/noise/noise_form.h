// The forms among which a noise fit chooses (calib/noise/noise_fit.h), and where the fit of each starts.
#pragma once

#include <vector>

#include "calib/noise/noise_fit.h"

namespace sonarcal::calib {

struct NoiseForm {
  DisplayParameters<double> display;
  bool fit_span = false;  // else the looks
  sim::SpeckleLaw speckle = sim::SpeckleLaw::kGamma;
  TimeVariedGain time_varied_gain = TimeVariedGain::kNone;
  bool floor_after_gain = true;
};

// Steps from the plainest form.
int Richness(const NoiseForm& form);

// What the recording's metadata leave open of display and speckle, with two floors and no gain; the plainest
// first. options.display, where set, stands for the metadata.
std::vector<NoiseForm> DisplayForms(const RecordingInfo& info, const NoiseFitOptions& options);

// Starting values; `net_db`: change of the floor before the gain over the window, as displayed.
NoiseLaw StartOf(const NoiseForm& form, const NoiseCounts& counts, const NoiseCells& cells, double net_db,
                 double absorption_db_per_m);

}  // namespace sonarcal::calib
