// Refines the poses of frames of a known scene, with the radiometry fixed, from slightly wrong recorded
// poses. Refines the sonar's geometry and the placement of objects too, if they are free.
//
// Gauss-Newton with damping (Levenberg, Marquardt) on the cost of calib/poses/pose_view.h and the priors of
// the catalog. Every step traces the scene again and is accepted only if the cost falls. Derivatives by
// moves of the sonar or of objects come from the same trace, others from central differences of traced
// images (calib/parameters/pose_step.h). They are used for up to three steps. Frames are refined one by one,
// or all together if a placement that they share is free.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/models/acoustic_frame_model.h"
#include "calib/poses/pose_view.h"

namespace sonarcal::calib {

struct PoseStage {
  PoseSmoothing smoothing;
  int slopes = 2;            // max number of times that derivatives are traced
  int decimation = 1;        // decimation of the rows and columns of rays
  bool along_ridge = false;  // jumps along the direction that the frames determine least
  bool sweep = false;        // first tries headings and distances within twice the prior sigma
};

// Returns the stages: smoothing over about four speckle cells, over one, and the likelihood.
std::vector<PoseStage> PoseStages(const FrameModel::SpeckleCell& speckle_cell);

// Returns the free placements of the catalog.
std::vector<int> FreePlacements(const std::vector<CatalogEntry>& catalog, const std::vector<bool>& free);

// Moves the placements `entries` of `values`. `catalog` is that of the model, with bounds and priors.
void RefinePoses(const AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
                 const std::vector<int>& entries, const PoseStage& stage, ParameterValues& values,
                 const std::function<void(const std::string&)>& progress = {});

}  // namespace sonarcal::calib
