// The variants among which calib/selection/model_choice.h chooses, as changes to a model.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/parameters/fit_config.h"
#include "core/types/parameters.h"

namespace sonarcal::calib {

// A change to a model. `apply` is asked for what the model starts from and for where the fit of it starts.
struct ModelVariant {
  std::string name;
  int fitted_values = 0;
  bool given = false;  // no change
  std::function<void(ParameterSet&)> apply = [](ParameterSet&) {};
  std::function<void(FitConfig&)> configure = [](FitConfig&) {};
};

// The pattern given, and the others at the same width.
std::vector<ModelVariant> AzimuthVariants(const BeamParameters& given);
std::vector<ModelVariant> ElevationVariants(const BeamParameters& given);

// The lobes through which mirrors are seen: those given, and the others.
std::vector<ModelVariant> MirrorLobeVariants(const BeamParameters& given);

// For people.
const char* DisplayName(DisplayLaw law);

}  // namespace sonarcal::calib
