// The law of the background that `sonarcal fit --noise-only` writes into params.json, as plain numbers for
// metrics/segmentation/likelihood_ratio.h.
#pragma once

#include <filesystem>

#include "core/types/parameters.h"
#include "metrics/segmentation/background_law.h"

namespace sonarcal {

// The noise floor of every pixel, in the unit of the display, without absorption, as the noise is fitted.
// Throws DataError, beginning with `where`, where the parameters have no noise floor or tapers for another
// number of beams.
BackgroundLaw BackgroundLawOf(const ParameterSet& parameters, const PolarAxes& axes,
                              const std::string& where);

}  // namespace sonarcal
