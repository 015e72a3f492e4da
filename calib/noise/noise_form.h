// Candidate forms of a noise law (calib/noise/noise_fit.h), and their start values.
#pragma once

#include <vector>

#include "calib/noise/noise_fit.h"

namespace sonarcal::calib {

struct NoiseForm {
  DisplayParameters<double> display;
  bool fit_span = false;     // false: the looks are fitted
  bool fit_soft_db = false;  // false: that of `display` is kept
  sim::SpeckleLaw speckle = sim::SpeckleLaw::kGamma;
  TimeVariedGain time_varied_gain = TimeVariedGain::kNone;
  bool floor_after_gain = true;
};

// Power that a display does not show, 40 dB below db_min. It stands for levels that are shown as black.
double UnshownPower(const DisplayParameters<double>& display);

// Number of steps from the plainest form.
int Richness(const NoiseForm& form);

// Returns the forms of display and speckle that the metadata of the recording allow, with two floors and no
// gain, the plainest first. options.display, if set, replaces the metadata.
std::vector<NoiseForm> DisplayForms(const RecordingInfo& info, const NoiseFitOptions& options);

// Start values. `net_db`: change of the floor before the gain over the window, as displayed.
NoiseLaw StartOf(const NoiseForm& form, const NoiseCounts& counts, const NoiseCells& cells, double net_db,
                 double absorption_db_per_m);

// Start values of several starts. With two floors: the floor before the gain falls with range, or rises. With
// a diffuse component: texture in all of the power, or strong texture in a small share of it.
std::vector<NoiseLaw> StartsOf(const NoiseForm& form, const NoiseCounts& counts, const NoiseCells& cells,
                               double absorption_db_per_m);

}  // namespace sonarcal::calib
