// Refines the poses of frames of a known scene, the radiometry held, from recorded poses that are a little
// off.
//
// Gauss-Newton with damping (Levenberg, Marquardt) on the cost of calib/poses/pose_view.h and the priors of
// the catalog. Every step traces the scene again and is taken only where the cost falls; slopes are central
// differences of traced images, by small moves of the sonar (calib/parameters/pose_step.h), and serve up to
// three steps. Frames are refined one by one, or all together where a mount offset that they share is free.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/models/acoustic_frame_model.h"
#include "calib/poses/pose_view.h"

namespace sonarcal::calib {

struct PoseStage {
  PoseSmoothing smoothing;
  int slopes = 2;            // times they are traced, at most
  int thin = 1;              // rows and columns of rays are fewer by this factor
  bool along_ridge = false;  // jump along what the frames tell least
  bool sweep = false;        // try headings and distances within twice the prior's sigma before
};

// From far to near: smoothing over about four grains of speckle, over one, and the likelihood.
std::vector<PoseStage> PoseStages(const FrameModel::Grain& grain);

// Entries of the catalog that are free and decide a pose.
std::vector<int> FreePoseEntries(const std::vector<CatalogEntry>& catalog, const std::vector<bool>& free);

// Moves the `entries` of `values`, all of them of poses; `catalog` is the model's, with bounds and priors.
// Returns by how much their cost fell, a sweep's part left out.
double RefinePoses(const AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
                   const std::vector<int>& entries, const PoseStage& stage, ParameterValues& values,
                   const std::function<void(const std::string&)>& progress = {});

}  // namespace sonarcal::calib
