// Cost of a recorded frame by its pose, with given radiometry.
//
// Two kinds of cost. Smoothed: the mean displayed value, with recorded and expected image smoothed alike;
// speckle then has about the same size everywhere. Only this cost has a useful slope from poses so far away
// that edges do not overlap. By likelihood: the logarithm of the mean power, with the law of speckle about it
// (calib/models/power_likelihood.h). Either cost is divided by the number of pixels in a speckle cell, so
// that it can be weighed against a prior. Pixels have the weights of the fit (AcousticFrameModel::Weight).
#pragma once

#include <Eigen/Core>
#include <span>
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
  using Rays = AcousticFrameModel::Rays;

  // The model must outlive the view. For a smoothed view, the size of speckle comes from the difference of
  // the frame and its expected image at `about`.
  PoseView(const AcousticFrameModel& model, int frame, const ParameterSet& parameters,
           const PoseSmoothing& smoothing, const Rays& rays, const Pose& about);

  // Mean power at a pose. Traces.
  Grid<float> PowerFrom(const Pose& world_from_sonar, const Rays& rays) const;

  // Returns the expected value of each pixel.
  Eigen::VectorXf Expected(const Grid<float>& power) const;
  Eigen::VectorXf Expected(const Pose& world_from_sonar, const Rays& rays) const {
    return Expected(PowerFrom(world_from_sonar, rays));
  }

  // Changes of the expected value of each pixel per unit of changes of the power of echoes, one column each.
  // `echoes`: power of the echoes, without noise, at the pose.
  Eigen::MatrixXf Slopes(const Grid<double>& echoes, std::span<const Grid<float>> changes) const;

  struct Evaluation {
    double cost = 0.0;            // half of -2 log likelihood, up to a constant
    Eigen::VectorXd score;        // -d cost / d expected, pixel by pixel
    Eigen::VectorXd information;  // the mean of d^2 cost / d expected^2
  };
  Evaluation Evaluate(const Eigen::VectorXf& expected) const;

 private:
  Grid<float> ExpectedShown(const Grid<float>& power) const;
  bool Counts(std::size_t pixel) const { return model_.Counts(frame_, pixel); }

  const AcousticFrameModel& model_;
  int frame_;
  ParameterSet parameters_;
  PoseSmoothing smoothing_;
  double pixels_per_cell_;
  double lowest_;  // power at the bottom of the display; below, at its top
  double highest_;
  Grid<float> shown_;    // smoothed views: recorded image, not smoothed
  double weight_ = 0.0;  // smoothed views: weight of a squared difference
};

}  // namespace sonarcal::calib
