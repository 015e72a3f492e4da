// Fits the parameters of the acoustic model to recorded polar images by maximum likelihood (Ceres).
//
// The likelihood is that of speckle about the mean power of every pixel
// (calib/models/acoustic_frame_model.h). Starts, standard errors and identifiability are those of
// calib/fit.h. Steps:
//
// 1. Curves and receiver. Casts the rays of each frame once.
// 2. Free poses, from large to small moves (calib/poses/pose_refinement.h), with curves refitted after each
//    stage.
//    Geometry of the sonar and placement of objects, if free, are refined with the poses. Outlines of objects
//    are left to step 3.
// 3. If beam, pulse or poses are free: all parameters together, in rounds about a new point. Each round
//    traces again.
// 4. On request (FitOptions::down_weight): all again with reduced weight of pixels that do not match the
//    scene.
//
// Frames of one pose share their speckle. Together they count for the information that they have together
// (AcousticFrameModel::ShareRepeats).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "calib/fit.h"
#include "calib/models/acoustic_frame_model.h"

namespace sonarcal::calib {

// Returns the parameters that a fit of the acoustic model frees by default: curves, noise floor, the pulse
// length if it is not given (the level per area depends on it), and those of MirrorsFreeByDefault. Gauge:
// gain and source level are fixed, so that the materials carry the level. The beam is fixed at that of the
// sonar.
std::vector<std::string> AcousticFreeByDefault(const ParameterSet& initial,
                                               const std::vector<std::string>& material_names);

// Returns the parameters with a start value of the noise level, from the darkest fifth of the used pixels, if
// they have none. If a soft display shows more of them without any power, the darkest pixel with power gives
// it. Throws DataError if there is none.
ParameterSet WithNoiseStart(ParameterSet parameters, const std::vector<AcousticFrame>& frames);

struct AcousticFit {
  ParameterSet parameters;
  std::vector<Pose> world_from_sonar;  // per frame; as given if poses were not free
  bool moved_poses = false;
  Pose mount;              // offset behind every recorded pose, with the tilt; identity if neither is free
  SonarGeometry geometry;  // as declared if not free
  // Traces with the fitted geometry and placement of objects. The given one if neither is free, and then not
  // owned.
  std::shared_ptr<const sim::Simulator> simulator;
  std::vector<std::vector<float>> weights;        // per frame and pixel; empty: all are 1
  std::vector<std::vector<float>> repeat_shares;  // see FitOptions::repeat_shares; empty if all poses differ
  FitReport report;
  bool usable = false;
};

// `initial` must have a noise level. Mirrors are completed as in WithMirrorStart. Throws DataError as
// FitPaperModel does.
AcousticFit FitAcousticModel(const sim::Simulator& simulator, const std::vector<AcousticFrame>& frames,
                             const ParameterSet& initial, const FitConfig& config,
                             const FitOptions& options = {});

// Fits the poses of frames with all other parameters fixed. For held-out frames, whose recorded poses would
// otherwise be known to be wrong.
std::vector<Pose> FitPosesOnly(const sim::Simulator& simulator, const std::vector<AcousticFrame>& frames,
                               const ParameterSet& parameters, const PosePrior& prior = {},
                               const std::function<void(const std::string&)>& progress = {});

}  // namespace sonarcal::calib
