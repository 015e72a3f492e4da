// A recorded frame as a search for its pose sees it, the radiometry given.
//
// Two ways. Smoothed: the mean displayed value, from which the recorded one differs by speckle of about the
// same size everywhere, both smoothed alike; from a distance where edges do not overlap, only this has a
// slope that leads back. By likelihood: the logarithm of the mean power, and speckle's own law about it
// (calib/models/power_likelihood.h). Either cost is divided by the pixels that share a grain of speckle, so
// that it may be weighed against a prior.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/models/acoustic_frame_model.h"

namespace sonarcal::calib {

// Standard deviations of the smoothing in range bins and beams; both 0: by likelihood.
struct PoseSmoothing {
  double bins = 0.0;
  double beams = 0.0;

  bool none() const { return bins <= 0.0 && beams <= 0.0; }
};

class PoseView {
 public:
  // Model and fan must outlive the view. The speckle of a smoothed view is sized by what the frame shows
  // beside what is expected at `about`.
  PoseView(const AcousticFrameModel& model, int frame, const ParameterSet& parameters,
           const PoseSmoothing& smoothing, const sim::RayFan& fan, const Pose& about);

  // What each pixel should show from a pose. Traces.
  Eigen::VectorXf Expected(const Pose& world_from_sonar) const;

  struct Judgement {
    double cost = 0.0;            // half of -2 log likelihood, up to a constant
    Eigen::VectorXd score;        // -d cost / d expected, pixel by pixel
    Eigen::VectorXd information;  // the mean of d^2 cost / d expected^2
  };
  Judgement Judge(const Eigen::VectorXf& expected) const;

 private:
  Grid<float> ExpectedShown(const PolarImage& power) const;
  bool Counts(std::size_t pixel) const { return model_.Counts(frame_, pixel); }

  const AcousticFrameModel& model_;
  int frame_;
  ParameterSet parameters_;
  PoseSmoothing smoothing_;
  const sim::RayFan& fan_;
  double pixels_a_grain_;
  double lowest_;  // power at the bottom of the display, and at its top
  double highest_;
  Grid<float> shown_;    // smoothed views: recorded, not smoothed
  double weight_ = 0.0;  // smoothed views: of a squared difference
};

}  // namespace sonarcal::calib
