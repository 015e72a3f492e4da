// Gain of the pose of each ping: the log-likelihood of frames whose beams have the poses of their pings,
// minus that of the same frames with one pose. Both have the same parameters, so the difference is not what
// a second fit would give: it absorbs part of the error in its curves.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/fit_report.h"
#include "calib/parameters/fit_options.h"
#include "calib/selection/held_out_likelihood.h"
#include "sim/simulator.h"

namespace sonarcal::calib {

// Returns nothing if no frame has pings with poses of their own. `pings` are those of the sonar. The caller
// sets PingWorth::used and PingWorth::held_out.
std::optional<PingWorth> MeasurePingWorth(const sim::Simulator& simulator,
                                          const std::vector<GreyFrame>& frames, const PingPattern& pings,
                                          const ParameterSet& parameters, const FitOptions& options = {});

// Sentences about the pings of a fit.
std::string PingWorthText(const PingWorth& worth);

}  // namespace sonarcal::calib
