// Steps of poses and curves together, each judged by images traced anew.
//
// Pitch and the slope of a floor's curve over range hang together, and so do height and level: fitting the
// one with the other held creeps along their valley, and a model that is linear in the pose, solved to its
// end, leaves it. A step of Gauss and Newton over all of them, damped (Levenberg, Marquardt), goes down the
// valley at once; it is taken only where the cost of the scene traced from the new poses is lower, or no
// higher than it varies by from pose to pose. Where the steps end is the mean of the points whose costs are
// alike so.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/models/acoustic_frame_model.h"

namespace sonarcal::calib {

struct JointStepOptions {
  int steps = 6;  // at most
  // Fall of the cost, in half of -2 log likelihood, that a step must promise.
  double least = 1.0;
  // By how much the cost of a frame goes up and down from one pose to the next, as rays come and go at edges.
  // A step may cost so much, times the root of the number of frames: along a flat valley each lower cost
  // would else be the last, by chance.
  double roughness = 0.0;
};

// Moves the entries `active` of `values`, within their bounds; `catalog` is the model's, with bounds and
// priors. `settle`, where given, fits what needs no tracing, about the model's present point, for every step
// tried.
// The model is linear about the values reached, in those of the entries that are geometric. Returns whether
// the steps came to an end before they were used up.
bool TakeJointSteps(AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
                    const std::vector<int>& active, const JointStepOptions& options,
                    const std::function<void(ParameterValues&)>& settle, ParameterValues& values,
                    const std::function<void(const std::string&)>& progress = {});

}  // namespace sonarcal::calib
