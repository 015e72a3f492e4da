// A fit to some frames of a recording, and the likelihood of others: how a calibration tries what it may
// free.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "apps/workflow/fit.h"
#include "calib/acoustic_fit.h"
#include "calib/problem_builder.h"
#include "calib/selection/held_out_likelihood.h"

namespace sonarcal::workflow {

// Frames of a recording with its own poses.
std::vector<calib::GreyFrame> GreyFrames(const RecordingSource& recording, const std::vector<int>& indices);

struct Trial {
  calib::AcousticFit fit;
  std::vector<Pose> held_out_poses;
  calib::BlockedLikelihood likelihood;  // of the held-out frames; empty if none is held out
};

class HeldOutTrials {
 public:
  // The simulator must outlive this.
  HeldOutTrials(const sim::Simulator& simulator, std::vector<calib::GreyFrame> used,
                std::vector<calib::GreyFrame> held_out)
      : simulator_(simulator), used_(std::move(used)), held_out_(std::move(held_out)) {}

  // Fits and evaluates. The poses of the held-out frames are fitted too if those of the others are free. A
  // fit with several starts begins with Search.
  Trial Try(const ParameterSet& parameters, calib::FitConfig config, calib::FitOptions options);

  // Fits to blocks of pixels of about half a speckle cell: a search that is quicker by as many pixels.
  calib::AcousticFit Search(const ParameterSet& parameters, const calib::FitConfig& config,
                            const calib::FitOptions& options) const;

  // Likelihood of `a` minus that of `b`, nats per pixel, and how many standard errors that is. With no
  // held-out frame, both are 0.
  static calib::LikelihoodDifference Gain(const Trial& a, const Trial& b);

  const std::vector<calib::GreyFrame>& used() const { return used_; }
  const std::vector<calib::GreyFrame>& held_out() const { return held_out_; }
  const sim::Simulator& simulator() const { return simulator_; }

 private:
  const sim::Simulator& simulator_;
  std::vector<calib::GreyFrame> used_;
  std::vector<calib::GreyFrame> held_out_;
  std::optional<calib::BlockPixels> block_;  // the same for all trials
};

// Lets a fit start at the values of another one.
void StartAt(const calib::FitReport& found, calib::FitConfig& config);

// Returns true if a gain is more than two standard errors.
bool IsSignificant(const calib::LikelihoodDifference& gain);

}  // namespace sonarcal::workflow
