// Pose problem of frames with common parameters: cost, derivatives and steps, with the radiometry fixed. The
// sonar's geometry and the placement of objects may be among the parameters.
// pose_refinement.h and pose_ambiguity.h contain the strategies that use it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/models/acoustic_frame_model.h"
#include "calib/parameters/pose_step.h"
#include "calib/poses/damped_steps.h"
#include "calib/poses/pose_view.h"

namespace sonarcal::calib {

// Returns a named pose with whole turns added to its angles, so that each is within half a turn of that of
// `near`.
PoseStep NearestTurns(PoseStep named, const PoseStep& near);

class PoseProblem {
 public:
  // Model and catalog must outlive the problem. `catalog` is that of the model, with bounds and priors. All
  // `entries` are placements. `decimation`: of the rows and columns of rays.
  PoseProblem(const AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
              const PoseSmoothing& smoothing, int decimation, std::vector<int> frames,
              std::vector<int> entries, const ParameterValues& values);
  ~PoseProblem() = default;
  PoseProblem(const PoseProblem&) = delete;
  PoseProblem& operator=(const PoseProblem&) = delete;

  struct State {
    ParameterValues values;
    std::vector<PoseView::Evaluation> evaluated;  // per frame
    double cost = 0.0;                            // nats, including priors
  };
  State At(const ParameterValues& values) const;

  // Changes per small move of the sonar, then per unit of each entry of geometry and objects. One matrix per
  // frame: pixels x (kPoseSteps + number of those entries).
  using Slopes = std::vector<Eigen::MatrixXf>;
  Slopes SlopesAt(const ParameterValues& values) const;

  QuadraticCost NormalAt(const State& state, const Slopes& slopes) const;

  // DampedStep of the entries, within their bounds.
  double Step(const Slopes& slopes, double& damping, State& state) const;

  // Direction among the entries that a state determines least, with a length of one prior sigma.
  Eigen::VectorXd Ridge(const State& state, const Slopes& slopes) const;

  // Returns the values with the entries moved, within their bounds.
  ParameterValues MovedEntries(const ParameterValues& values, const Eigen::VectorXd& by) const;

  // As above for one whole pose, moved along the axes of the sonar. Only if EntryOf has its components.
  ParameterValues MovedSonar(const ParameterValues& values, const PoseStep& by) const;

  // Entry of a component of the pose (order of kPoseNames), if the problem is one whole pose; otherwise -1.
  int EntryOf(int component) const;

  const CatalogEntry& entry(int index) const { return catalog_[index]; }

 private:
  // Without priors.
  QuadraticCost OfFrames(const State& state, const Slopes& slopes) const;
  Eigen::VectorXd PriorSigmas() const;
  void AddPriors(const ParameterValues& values, QuadraticCost& normal) const;
  // d column of the slopes / d value of each entry.
  Eigen::MatrixXd MovesOfEntries(int frame, const ParameterValues& values) const;
  void AddSlopesOfScene(const ParameterValues& values, Slopes& slopes) const;
  void Set(int entry, double value, ParameterValues& values) const;

  const AcousticFrameModel& model_;
  const std::vector<CatalogEntry>& catalog_;
  std::vector<int> entries_;
  std::vector<int> frames_;
  std::vector<int> common_;  // entries of geometry and objects
  int decimation_;
  std::vector<PoseView> views_;
};

}  // namespace sonarcal::calib
