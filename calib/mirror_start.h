// What a fit of mirrors begins with where nobody gives it: the losses, and how far aside is sent.
#pragma once

#include <string>
#include <vector>

#include "calib/parameters/fit_config.h"
#include "core/types/parameters.h"
#include "core/types/sonar_model.h"

namespace sonarcal::calib {

// A loss to start from where a mirror is named among what is free, but not in the parameters: that of a
// surface that reflects a third of the pressure.
inline constexpr double kStartLossDb = 10.0;

// How far beyond the outer beams a transmitter is taken to send at first, where that is fitted and not given:
// it is even over the beams and falls as a cosine of pressure from there on.
inline constexpr double kStartTransmitDeg = 20.0;

// What a fit frees of mirrors where nobody says: the losses of those that the scene has, and beam.
// transmit_end_deg where it is not given, as most of what walls show may come in from beside the beams. Empty
// where the scene has none.
std::vector<std::string> MirrorsFreeByDefault(const ParameterSet& initial,
                                              const std::vector<std::string>& material_names);

// The parameters with what a configuration frees of mirrors: an entry for each `mirror.<material>.loss_db`
// that it names in full, and a transmitter that sends beyond the beams where its end is free and not given.
ParameterSet WithMirrorStart(ParameterSet initial, const FitConfig& config,
                             const std::vector<std::string>& material_names, const SonarModel& sonar);

}  // namespace sonarcal::calib
