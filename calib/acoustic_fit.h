// Fits the acoustic model's parameters to recorded polar images by maximum likelihood (Ceres).
//
// The likelihood is that of speckle about the mean power of every pixel
// (calib/models/acoustic_frame_model.h); the rest is calib/fit.h: several starts, sigmas from a sandwich over
// blocks of pixels, and what the data cannot tell held and named. A fit of curves and receiver casts each
// frame's rays once. Free poses are first looked for from far to near (calib/poses/pose_refinement.h), curves
// following. Where beam, pulse or poses are free, all is then solved together in rounds about an ever better
// point, each tracing again. Frames of one pose share their speckle and count for what they tell together
// (AcousticFrameModel::ShareRepeats). On request (FitOptions::down_weight) it is then solved again with what
// the scene does not explain counting less.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/fit.h"
#include "calib/models/acoustic_frame_model.h"

namespace sonarcal::calib {

// What a fit of the acoustic model frees where nobody says: curves and noise floor, the pulse where its
// length is not given, as a level per area hangs on it, and what MirrorsFreeByDefault says. The gauge: gain
// and source level stay, so that the materials carry the level; the beam stays as the sonar's own.
std::vector<std::string> AcousticFreeByDefault(const ParameterSet& initial,
                                               const std::vector<std::string>& material_names);

// Level of the noise floor in the darkest fifth of the recorded pixels, dB: where a fit starts.
double NoiseStartDb(const std::vector<AcousticFrame>& frames, double looks);

struct AcousticFit {
  ParameterSet parameters;
  std::vector<Pose> world_from_sonar;  // by frame; those given, where poses were not free
  bool moved_poses = false;
  Pose mount;                               // the offset behind every recorded pose; none where not free
  std::vector<std::vector<float>> weights;  // by frame and pixel; empty: all counted in full
  FitReport report;
  bool usable = false;
};

// `initial` must name a noise level; of mirrors it is completed as WithMirrorStart says. Throws DataError as
// FitPaperModel does.
AcousticFit FitAcousticModel(const sim::Simulator& simulator, const std::vector<AcousticFrame>& frames,
                             const ParameterSet& initial, const FitConfig& config,
                             const FitOptions& options = {});

// The poses of frames, radiometry and all else held: for frames that a fit did not see, which would otherwise
// be judged at poses known to be off.
std::vector<Pose> FitPosesOnly(const sim::Simulator& simulator, const std::vector<AcousticFrame>& frames,
                               const ParameterSet& parameters, const PosePrior& prior = {},
                               const std::function<void(const std::string&)>& progress = {});

}  // namespace sonarcal::calib
