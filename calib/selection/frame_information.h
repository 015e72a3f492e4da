// Expected information of frames of the acoustic model, before any image is read: how well a frame from a
// pose will determine curves, noise level and geometry. The choice of frames uses it
// (calib/selection/frame_choice.h).
//
// Few rays and coarse pixels serve. A block of pixels has the information of its speckle cells. No pixel is
// clipped by the display.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/models/acoustic_frame_model.h"
#include "calib/parameters/fit_config.h"
#include "calib/selection/frame_choice.h"
#include "core/types/parameters.h"
#include "core/types/pose.h"
#include "sim/simulator.h"

namespace sonarcal::calib {

struct FrameInformationOptions {
  bool geometry = true;  // offset and scale of range and azimuth are parameters
  // Poses are wrong by an error that all frames share, which is a parameter, and by one of their own, of
  // which only the standard deviation is known.
  bool poses = true;
  PosePrior pose_prior = {};
  int max_bins = 125;  // of the coarse pixels
  int max_beams = 64;
  int max_rows = 200;  // of rays
};

class FrameInformation {
 public:
  // Takes scene, sonar and options from `simulator`, which must outlive this. Parameters are linear about
  // `parameters`. Mirrors of the parameters are left out. Without a noise level, that of the darkest fifth of
  // the expected pixels is taken.
  FrameInformation(const sim::Simulator& simulator, const ParameterSet& parameters, std::vector<Pose> poses,
                   const FrameInformationOptions& options = {});

  // Names of the parameters, in the order of the information.
  const std::vector<std::string>& names() const { return names_; }

  // Information of each pose, names().size() squared, in units of the priors' standard deviations.
  // `frames_before`: number of other frames from each pose, with which a frame of a static scene shares its
  // speckle; empty: none. The time is linear in the number of poses.
  std::vector<Eigen::MatrixXd> Of(const std::vector<int>& poses,
                                  const std::vector<int>& frames_before = {}) const;

 private:
  AcousticFrame FrameAt(int pose) const;  // without a recorded image
  double NoiseOfDarkest() const;          // dB
  Eigen::MatrixXd OfFrame(const AcousticFrameModel& model, int frame, const std::vector<int>& active,
                          int before) const;

  std::vector<Pose> poses_;
  FrameInformationOptions options_;
  ParameterSet parameters_;
  std::optional<sim::Simulator> coarse_;
  double cells_per_pixel_ = 1.0;  // speckle cells of the sonar in a coarse pixel
  std::vector<std::string> names_;
};

// Chooses among `poses` by information. `frames_of_pose`: number of frames per pose.
InformationChoice ChooseByInformation(const std::vector<int>& frames_of_pose,
                                      const FrameInformation& information,
                                      const ChooseByInformationOptions& options = {});

}  // namespace sonarcal::calib
