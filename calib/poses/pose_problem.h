// Frames whose poses hang together, and the catalog entries that decide them: cost, slopes and steps, the
// radiometry held. Strategies that use it are in pose_refinement.h and pose_ambiguity.h.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/models/acoustic_frame_model.h"
#include "calib/parameters/pose_step.h"
#include "calib/poses/pose_view.h"

namespace sonarcal::calib {

class PoseProblem {
 public:
  // Model and catalog must outlive the problem; `catalog` is the model's, with bounds and priors, and
  // `entries` are all of poses. Rows and columns of rays are fewer by the factor `thin`.
  PoseProblem(const AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
              const PoseSmoothing& smoothing, int thin, std::vector<int> frames, std::vector<int> entries,
              const ParameterValues& values);
  PoseProblem(const PoseProblem&) = delete;
  PoseProblem& operator=(const PoseProblem&) = delete;

  struct State {
    ParameterValues values;
    std::vector<PoseView::Judgement> judged;  // by frame
    double cost = 0.0;                        // nats, priors included
  };
  State At(const ParameterValues& values) const;

  // What a small move of the sonar changes, frame by frame: pixels x kPoseSteps.
  using Slopes = std::vector<Eigen::MatrixXf>;
  Slopes SlopesAt(const ParameterValues& values) const;

  // Second derivative and slope of the cost by the entries, about a state.
  struct Normal {
    Eigen::MatrixXd information;
    Eigen::VectorXd score;
  };
  Normal NormalAt(const State& state, const Slopes& slopes) const;

  // A damped step (Levenberg, Marquardt) to a lower cost; returns by how much it fell, 0 where none made it.
  double Step(const Slopes& slopes, double& damping, State& state) const;

  // The direction among the entries that a state tells least, one sigma of the priors long.
  Eigen::VectorXd Ridge(const State& state, const Slopes& slopes) const;

  // The values with the entries moved, within their bounds.
  ParameterValues MovedEntries(const ParameterValues& values, const Eigen::VectorXd& by) const;

  // The same for one whole pose, moved as the sonar moves; only where EntryOf knows its components.
  ParameterValues MovedSonar(const ParameterValues& values, const PoseStep& by) const;

  // Of one whole pose, the entry of a component (order of kPoseNames); -1 where the problem is anything else.
  int EntryOf(int component) const;

  const CatalogEntry& entry(int index) const { return catalog_[index]; }

 private:
  Eigen::MatrixXd MovesOfEntries(int frame, const ParameterValues& values) const;
  void Set(int entry, double value, ParameterValues& values) const;

  const AcousticFrameModel& model_;
  const std::vector<CatalogEntry>& catalog_;
  std::vector<int> entries_;
  std::vector<int> frames_;
  sim::RayFan fan_;
  std::vector<PoseView> views_;
};

}  // namespace sonarcal::calib
