// Start values and free parameters of mirrors: their losses, and how far the transmitter sends beside the
// beams.
#pragma once

#include <string>
#include <vector>

#include "calib/parameters/fit_config.h"
#include "core/types/parameters.h"
#include "core/types/sonar_model.h"

namespace sonarcal::calib {

// Start value of a loss that is free but not given: that of a surface that reflects a third of the pressure.
inline constexpr double kStartLossDb = 10.0;

// Start value of the angle beyond the outer beams up to which a transmitter sends, if it is free but not
// given; at most the limit of params.json. The pressure is even over the beams and falls as a cosine beyond
// them.
inline constexpr double kStartTransmitDeg = 20.0;

// Returns the mirror parameters that a fit frees by default: the losses of the mirrors in the scene, and
// beam.transmit_end_deg if it is not given, because most of what walls reflect may come from beside the
// beams. Empty if the scene has no mirrors.
std::vector<std::string> MirrorsFreeByDefault(const ParameterSet& initial,
                                              const std::vector<std::string>& material_names);

// Returns the parameters with entries for the mirrors that a configuration frees: one for each
// `mirror.<material>.loss_db` with its full name, and a transmitter that sends beyond the beams if its end is
// free and not given.
ParameterSet WithMirrorStart(ParameterSet initial, const FitConfig& config,
                             const std::vector<std::string>& material_names, const SonarModel& sonar);

}  // namespace sonarcal::calib
