// Variants for calib/selection/model_choice.h, as changes to a model.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/parameters/fit_config.h"
#include "core/types/parameters.h"

namespace sonarcal::calib {

// A change to a model. `apply` is called for the initial parameters of the model and for the start of its
// fit.
struct ModelVariant {
  std::string name;
  int fitted_values = 0;
  bool given = false;  // no change
  std::function<void(ParameterSet&)> apply = [](ParameterSet&) {};
  std::function<void(FitConfig&)> configure = [](FitConfig&) {};
};

// Return the given pattern, and the others at the same width.
std::vector<ModelVariant> AzimuthVariants(const BeamParameters& given);
std::vector<ModelVariant> ElevationVariants(const BeamParameters& given);

// Returns the given lobes through which mirrors are seen, and the others.
std::vector<ModelVariant> MirrorLobeVariants(const BeamParameters& given);

// Name for display.
const char* DisplayName(DisplayLaw law);

}  // namespace sonarcal::calib
