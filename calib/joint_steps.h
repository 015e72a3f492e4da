// Steps of poses and curves together, each tested by tracing again.
//
// Pitch is correlated with the slope of the floor's backscatter curve over range, and height with the level.
// Fitting one with the other fixed creeps along their valley. A model that is linear in the pose, solved to
// its end, leaves the valley. A damped Gauss-Newton step (Levenberg, Marquardt) over all of them follows the
// valley directly. It is accepted only if the cost of the scene traced from the new poses is lower, or higher
// by no more than its variation from pose to pose. The result is the mean of the points whose costs are equal
// within that variation.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/models/acoustic_frame_model.h"

namespace sonarcal::calib {

struct JointStepOptions {
  int steps = 6;  // max
  // Min predicted fall of the cost, half of -2 log likelihood.
  double least = 1.0;
  // Returns the cost of all frames, without priors, traced at these values.
  std::function<double(const ParameterValues&)> cost;
  // Returns the variation of that cost from one pose to the next, because rays appear and disappear at edges.
  // A step may raise the cost by this over the lowest one. Otherwise a low cost by chance would stop the
  // steps in a flat valley.
  std::function<double(const ParameterValues&)> roughness;
  // Refits the parameters that need no tracing, about the point at which the model is linearised. Called
  // after each step, if given: curves are less linear than poses. The result is taken only if it lowers the
  // cost, because the refit may use blocks of pixels.
  std::function<void(ParameterValues&)> settle = {};
};

// Moves the entries `active` of `values` within their bounds. `catalog` is that of the model, with bounds and
// priors. Leaves the model linearised about some point of the search. Returns false if the max number of
// steps ended the search.
bool TakeJointSteps(AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
                    const std::vector<int>& active, const JointStepOptions& options, ParameterValues& values,
                    const std::function<void(const std::string&)>& progress = {});

}  // namespace sonarcal::calib
